//! `bake tables`: made, shown, checked; what is no table file is refused with the reason.

use crate::bake::Desk;
use bake_formats::table_file::TableFile;

/// The smallest file that a recipe allows.
const SMALL: &str = "tables generate --bins 16 --bands 3 --scatter-orders 2";

#[test]
fn a_file_is_made_shown_and_checked_whatever_the_thread_count() {
    let desk = Desk::new();
    for threads in [1, 2, 7] {
        desk.bake(&format!("{SMALL} -o {threads}.tables --threads {threads}")).expect(0, &[]);
    }
    let bytes = |name: &str| std::fs::read(desk.path(name)).expect("written");
    assert!(
        bytes("1.tables") == bytes("2.tables") && bytes("1.tables") == bytes("7.tables"),
        "same recipe, same bytes"
    );

    let shown = desk.bake("tables inspect 1.tables --svg p.svg --table point.orders");
    assert_eq!(shown.code, Some(0), "{}", shown.err);
    let manifest: serde_json::Value = serde_json::from_str(&shown.out).expect("JSON on standard output");
    assert_eq!(manifest["recipe"]["grid"]["bins"], 16);
    assert!(manifest["tables"][0]["look_up_error"].as_f64().is_some_and(|e| e > 0.0 && e < 1.0));
    assert!(std::fs::read_to_string(desk.path("p.svg")).expect("written").contains("l = 2"));
    desk.bake("tables verify 1.tables --samples 2").expect(0, &[]);
}

#[test]
fn the_published_layout_is_made_and_checked_too() {
    let desk = Desk::new();
    desk.bake(&format!("{SMALL} --layout paper -o paper.tables")).expect(0, &[]);
    let shown = desk.bake("tables inspect paper.tables");
    let manifest: serde_json::Value = serde_json::from_str(&shown.out).expect("JSON on standard output");
    assert_eq!(manifest["recipe"]["layout"], "paper");
    desk.bake("tables verify paper.tables --samples 2").expect(0, &[]);
    desk.bake(&format!("{SMALL} --layout papre")).expect(2, &["papre", "paper-irradiance"]);
}

#[test]
fn the_tables_of_the_program_hold_what_they_state() {
    let ended = Desk::new().bake("tables verify --samples 1");
    assert_eq!(ended.code, Some(0), "{}{}", ended.out, ended.err);
    assert!(ended.out.contains("area.single"), "{}", ended.out);
}

#[test]
fn a_spoiled_number_fails_verification() {
    let desk = Desk::new();
    desk.bake(&format!("{SMALL} -o a.tables")).expect(0, &[]);
    let mut file = TableFile::read(&desk.path("a.tables")).expect("just written");
    let columns = file.manifest.tables[1].columns;
    // Higher orders of a point light, 30 % too bright at all distances: the hash fits, the numbers do not.
    assert_eq!(file.manifest.tables[1].name, "point.orders");
    file.values[1].iter_mut().step_by(columns).for_each(|value| *value *= 1.3);
    file.write(&desk.path("spoiled.tables")).expect("written");
    let ended = desk.bake("tables verify spoiled.tables --samples 2");
    ended.expect(2, &["point.orders", "where the file states", "bake tables generate"]);
}

#[test]
fn strangers_older_versions_and_damage_are_refused_with_the_reason() {
    let desk = Desk::new();
    let good = tables::set::embedded_bytes();
    let mut older = good.to_vec();
    older[8] -= 1;
    let mut damaged = good.to_vec();
    damaged[good.len() / 2] ^= 1;
    desk.write("stranger", b"PNG, or whatever else");
    desk.write("older", older);
    desk.write("damaged", damaged);
    desk.write("cut", &good[..good.len() / 2]);
    for command in ["inspect", "verify"] {
        for (file, reason) in [
            ("stranger", "this is no table file"),
            ("older", "table file version 1, this program reads version 2"),
            ("damaged", "do not match the hash"),
            ("cut", "do not match the hash"),
            ("nowhere", "cannot read"),
        ] {
            desk.bake(&format!("tables {command} {file}")).expect(2, &[file, reason]);
        }
    }
}

#[test]
fn recipes_that_cannot_be_are_refused_before_any_work() {
    let desk = Desk::new();
    for (flags, words) in [
        ("--bins 3", ["bins is 3", "16 to 4096"]),
        ("--bands 2", ["bands is 2", "3 to 16"]),
        ("--scatter-orders 11", ["scatter_orders is 11", "2 to 10"]),
        ("--min 1 --max 0.5", ["range is 1:0.5", "allowed"]),
        ("--min NaN", ["NaN", "allowed"]),
    ] {
        desk.bake(&format!("tables generate {flags}")).expect(2, &words);
    }
    assert!(desk.list().is_empty(), "nothing is written");
    desk.bake(&format!("{SMALL} -o no/folder.tables"))
        .expect(1, &["cannot write no/folder.tables: its folder does not exist", "-o"]);
    let drawn = desk.bake("tables inspect --svg no/p.svg");
    drawn.expect(1, &["cannot write no/p.svg: its folder does not exist", "`--svg`"]);
}
