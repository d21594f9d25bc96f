//! `bake run --keep-paths` and `bake refog`: other air for a bake without tracing it again.

use crate::bake::Desk;
use bake_formats::{Package, Term};

const SMALL: &str = "--samples 32 --page-size 32 --max-pages 1 -q";

/// Total irradiance, summed over the page.
fn light(desk: &Desk, folder: &str) -> f64 {
    let package = Package::open(&desk.path(folder)).expect("a whole package");
    let image = package.image(&package.manifest.pages[0].lightmap).expect("readable");
    image.rgb::<[f32; 3]>("").expect("R, G and B").iter().flatten().map(|value| f64::from(*value)).sum()
}

/// A bake without air that was given fog against one with that fog; the wrong twin is what was kept.
#[test]
fn other_air_is_given_to_a_kept_bake() {
    let desk = Desk::with_room();
    desk.bake(&format!("run room.glb {SMALL} --keep-paths --keep-vacuum --probes 1")).expect(0, &[]);
    let fog = "--fog sigma_t=0.6,albedo=0.7";
    let ended = desk.bake(&format!("refog room.bake {fog} -o foggy"));
    ended.expect(0, &["written without probes, vacuum", "bake run"]);
    assert!(ended.out.contains("fold"), "{}", ended.out);
    desk.bake(&format!("run room.glb {SMALL} --mode tables {fog} -o truth")).expect(0, &[]);
    let [kept, folded, baked] = ["room.bake", "foggy", "truth"].map(|folder| light(&desk, folder));
    assert!((folded / baked - 1.0).abs() < 0.02, "{folded} against {baked}");
    assert!((kept / baked - 1.0).abs() > 0.1, "{kept} against {baked}: air makes a difference");
    let package = Package::open(&desk.path("foggy")).expect("a package");
    assert_eq!(package.manifest.terms, Term::ALL);
    assert_eq!(package.manifest.media.len(), 1);
    assert!(package.manifest.file("room.paths.zst").is_none(), "the paths stay where they are");

    desk.write("clear.bake.ron", "Bake(media: [])");
    desk.bake("refog room.bake --settings clear.bake.ron -o clear -q").expect(0, &[]);
    let clear = light(&desk, "clear");
    assert!((clear / kept - 1.0).abs() < 1e-3, "{clear} against {kept}: the same air again");
}

#[test]
fn what_cannot_be_folded_is_refused_with_the_way_out() {
    let desk = Desk::with_room();
    desk.bake(&format!("run room.glb {SMALL} --keep-paths -o kept")).expect(0, &[]);
    desk.bake(&format!("run room.glb {SMALL} -o plain")).expect(0, &[]);
    let fog = "--fog sigma_t=0.6,albedo=0.7";
    desk.bake("refog kept -o out").expect(2, &["the new air is not said", "--fog"]);
    desk.bake(&format!("refog kept {fog}")).expect(2, &["holds the paths", "-o DIR"]);
    desk.bake(&format!("refog kept {fog} -o kept")).expect(2, &["not overwritten", "-o DIR"]);
    desk.bake(&format!("refog plain {fog} -o out")).expect(2, &["holds no paths", "--keep-paths"]);
    desk.bake(&format!("run room.glb {SMALL} --keep-paths --mode walk")).expect(2, &["keep_paths", "Tables or Auto"]);
    desk.bake(&format!("run room.glb {SMALL} --keep-paths --sh1")).expect(2, &["keep_paths", "directions"]);

    let paths = desk.path("kept/room.paths.zst");
    let whole = std::fs::read(&paths).expect("readable");
    std::fs::write(&paths, &whole[..whole.len() - 9]).expect("written");
    desk.bake(&format!("refog kept {fog} -o out")).expect(2, &["room.paths.zst", "stale", "bytes"]);
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    std::fs::write(&paths, &flipped).expect("written");
    desk.bake(&format!("refog kept {fog} -o out")).expect(2, &["room.paths.zst", "stale", "BLAKE3"]);
    std::fs::write(&paths, &whole).expect("written");

    std::fs::rename(desk.path("room.glb"), desk.path("moved.glb")).expect("moved");
    desk.bake(&format!("refog kept {fog} -o out")).expect(2, &["room.glb", "--scene-file"]);
    let missing = desk.bake(&format!("refog kept {fog} -o out --scene-file no.glb"));
    missing.expect(2, &["the scene no.glb does not exist", "moved.glb"]);
    desk.bake(&format!("refog kept {fog} -o out --scene-file moved.glb -q")).expect(0, &[]);
    assert!(!desk.list().contains(&"kept.bake".to_owned()));
}

#[test]
fn the_plan_says_what_keeping_takes() {
    let desk = Desk::with_room();
    let ended = desk.bake(&format!("plan room.glb {SMALL} --keep-paths --fog sigma_t=0.5,albedo=1"));
    ended.expect(0, &[]);
    assert!(ended.out.contains("kept for `bake refog`") && ended.out.contains("paths are kept"), "{}", ended.out);
    desk.bake("plan room.glb --keep-paths --texels-per-m 4000 --samples 16000000 --page-size 1024 --max-pages 1")
        .expect(2, &["keep_paths", "GB", "texels_per_m"]);
}
