//! Damaged files: no panic, no hang, no memory out of proportion, and a message that names file, place and next step.

use bake_core::scene::{self, LoadError, LoadOptions};
use peak_alloc::PeakAlloc;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, MutexGuard};
use std::time::{Duration, Instant};
use testkit::reference::{shared, workspace};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// The allocator counts for the whole process, so tests take turns.
static TURN: Mutex<()> = Mutex::new(());

fn turn() -> MutexGuard<'static, ()> {
    TURN.lock().unwrap_or_else(|broken| broken.into_inner())
}

/// What users are promised, in time on a processor: a busy machine does not count against the loader.
const HANG: Duration = Duration::from_secs(2);

/// Time that this thread has run, which alone does the loading; wall time where the system does not say.
fn busy() -> Duration {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let statistics = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = statistics.and_then(|text| text.split(' ').next()?.parse().ok());
    nanoseconds.map_or_else(|| START.elapsed(), Duration::from_nanos)
}

/// What loading did.
struct Outcome {
    error: Option<LoadError>,
    seconds: f64,
}

/// Loads, and checks memory, time and message.
fn attempt(bytes: &[u8], path: &Path, input: u64) -> Outcome {
    let options = LoadOptions { require_light: false, ..LoadOptions::default() };
    let before = MEMORY.current_usage() as u64;
    MEMORY.reset_peak_usage();
    let start = busy();
    let result = scene::load_from_bytes(bytes, path, &options);
    let elapsed = busy() - start;
    let taken = (MEMORY.peak_usage() as u64).saturating_sub(before);
    // Allowances of the loader (geometry 16 MiB + 256 times the input, pixels 64 MiB + 1100 times), with working space.
    let allowed = (128 << 20) + 2000 * input;
    assert!(taken <= allowed, "{}: {taken} bytes for an input of {input}, allowed {allowed}", path.display());
    assert!(elapsed < HANG, "{}: {elapsed:?}", path.display());
    let error = result.err();
    if let Some(error) = &error {
        let text = error.to_string();
        assert!(text.contains("; ") && !error.fault.next_step().is_empty(), "no next step in: {text}");
        assert!(text.starts_with(&*error.file.to_string_lossy()), "no file in: {text}");
    }
    Outcome { error, seconds: elapsed.as_secs_f64() }
}

fn files_below(folder: &Path, out: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> =
        std::fs::read_dir(folder).expect("a folder").map(|e| e.expect("an entry").path()).collect();
    entries.sort();
    for path in entries {
        match path.is_dir() {
            true => files_below(&path, out),
            false if path.extension().is_some_and(|e| e == "gltf" || e == "glb") => out.push(path),
            false => {}
        }
    }
}

/// Error codes that a baker must find itself; the validator's report says where.
const OURS: &[&str] = &[
    "ACCESSOR_TOO_LONG",
    "BUFFER_VIEW_TOO_LONG",
    "BUFFER_BYTE_LENGTH_MISMATCH",
    "UNRESOLVED_REFERENCE",
    "NODE_LOOP",
    "NODE_PARENT_OVERRIDE",
    "GLB_INVALID_MAGIC",
    "GLB_INVALID_VERSION",
    "GLB_LENGTH_MISMATCH",
    "GLB_CHUNK_TOO_BIG",
    "GLB_UNEXPECTED_FIRST_CHUNK",
    "GLB_UNEXPECTED_END_OF_HEADER",
    "GLB_UNEXPECTED_END_OF_CHUNK_HEADER",
    "GLB_UNEXPECTED_END_OF_CHUNK_DATA",
    "GLB_DUPLICATE_CHUNK",
    "INVALID_JSON",
];

/// Files with several faults of which another one is met first: a buffer without a URI, a buffer without a length,
/// and a second parent, which is named as the child and its parent instead of the entry in the parent's list.
const OTHER_FAULT_FIRST: &[&str] = &["alignment.gltf", "invalid_uri_data_bytelength.gltf", "node_parent_override.gltf"];

/// Parts of a document that no bake reads.
const NOT_READ: &[&str] =
    &["normalTexture", "/animations", "/skins", "/cameras", "KHR_materials_variants", "/camera", "/skin"];

/// `/nodes/0/children/1` as `nodes[0].children[1]`.
fn dotted(pointer: &str) -> String {
    let mut out = String::new();
    for part in pointer.split('/').skip(1) {
        if part.parse::<u32>().is_ok() {
            out += &format!("[{part}]");
        } else {
            out += if out.is_empty() { "" } else { "." };
            out += part;
        }
    }
    out
}

#[test]
fn the_validators_own_test_files_are_survived_and_refused_by_place() {
    let Some(suite) = shared("assets/validator-suite") else { return };
    let _turn = turn();
    let mut files = Vec::new();
    files_below(&suite, &mut files);
    assert!(files.len() > 250, "only {} files", files.len());
    let (mut refused, mut placed, mut owed) = (0, 0, Vec::new());
    for path in &files {
        let bytes = std::fs::read(path).expect("readable");
        let outcome = attempt(&bytes, path, 1 << 20);
        refused += usize::from(outcome.error.is_some());
        let report = std::fs::read(format!("{}.report.json", path.display())).expect("a report");
        let report: serde_json::Value = serde_json::from_slice(&report).expect("JSON");
        let messages = report["issues"]["messages"].as_array().cloned().unwrap_or_default();
        let text = |m: &serde_json::Value, key: &str| m[key].as_str().unwrap_or_default().to_owned();
        let ours: Vec<_> = messages
            .iter()
            .filter(|m| m["severity"] == 0 && OURS.contains(&&*text(m, "code")))
            .map(|m| (text(m, "code"), text(m, "pointer")))
            .filter(|(_, pointer)| !NOT_READ.iter().any(|part| pointer.contains(part)))
            .collect();
        let Some(error) = outcome.error else {
            owed.extend(ours.iter().map(|(code, pointer)| format!("{}: {code} {pointer} not refused", path.display())));
            continue;
        };
        let Some((code, pointer)) = ours.first() else { continue };
        let place = format!("{} {}", error.object, error.fault);
        let near = |pointer: &str| place.contains(&dotted(pointer)) || dotted(pointer).starts_with(&error.object);
        match pointer.is_empty() || ours.iter().any(|(_, pointer)| near(pointer)) {
            true => placed += 1,
            false if OTHER_FAULT_FIRST.iter().any(|name| path.ends_with(name)) => {}
            false => owed.push(format!("{}: {code} {pointer} refused as {error}", path.display())),
        }
    }
    println!("{} files, {refused} refused, {placed} with the validator's place", files.len());
    assert!(owed.is_empty(), "{}", owed.join("\n"));
    assert!(placed >= 20, "only {placed} places were compared");
}

#[test]
fn a_hang_is_seen_in_processor_time() {
    // Sleeping is no work; a loop is.
    let start = busy();
    std::thread::sleep(Duration::from_millis(30));
    let slept = busy() - start;
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_secs(1) && busy() - start < Duration::from_millis(20) {
        std::hint::black_box(&start);
    }
    assert!(busy() - start >= Duration::from_millis(20) && slept < Duration::from_secs(1), "{slept:?}");
}

#[test]
fn instances_are_not_multiplied_out() {
    let Some(path) = shared("assets/khr-teapots_galore/teapots_galore.gltf") else { return };
    let _turn = turn();
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let options = LoadOptions { require_light: false, ..LoadOptions::default() };
    let (scene, _) = scene::load(&path, &options).unwrap_or_else(|error| panic!("{error}"));
    let taken = MEMORY.peak_usage().saturating_sub(before);
    let triangles: usize = scene.instances.iter().map(|i| scene.meshes[i.mesh as usize].triangles.len()).sum();
    println!("{} instances of {triangles} triangles: peak {:.1} MiB", scene.instances.len(), taken as f64 / 1048576.0);
    assert_eq!(triangles, 7_656_770);
    // Multiplied out, corner indices alone would take 12 bytes a triangle.
    assert!(taken < 64 << 20, "{taken} bytes");
}

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// A GLB taken apart, so that damage gets past the framing.
#[derive(Clone)]
struct Glb {
    json: Vec<u8>,
    bin: Vec<u8>,
}

impl Glb {
    fn split(bytes: &[u8]) -> Self {
        let length = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
        let json_end = 20 + length(12);
        let bin = if bytes.len() > json_end { bytes[json_end + 8..].to_vec() } else { Vec::new() };
        Self { json: bytes[20..json_end].to_vec(), bin }
    }

    fn join(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
        for (kind, content) in [(b"JSON", &json), (b"BIN\0", &self.bin)] {
            out.extend((content.len() as u32).to_le_bytes());
            out.extend(kind);
            out.extend(content);
        }
        let length = out.len() as u32;
        out[8..12].copy_from_slice(&length.to_le_bytes());
        out
    }

    /// Replaces one number of the JSON part.
    fn change_number(&mut self, random: &mut Random) {
        const VALUES: &[&str] = &[
            "0",
            "1",
            "2",
            "3",
            "5",
            "7",
            "-1",
            "255",
            "65535",
            "4294967295",
            "4294967296",
            "18446744073709551615",
            "1e39",
            "-1e39",
            "0.5",
            "5120",
            "5121",
            "5123",
            "5125",
            "5126",
            "null",
            "\"x\"",
            "[]",
            "{}",
        ];
        let starts: Vec<usize> = (1..self.json.len())
            .filter(|&i| self.json[i].is_ascii_digit() && matches!(self.json[i - 1], b':' | b',' | b'[' | b' ' | b'-'))
            .collect();
        let Some(&start) = starts.get(random.below(starts.len())) else { return };
        let numeric = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'e' | b'E' | b'-' | b'+');
        let end = start + self.json[start..].iter().take_while(|b| numeric(b)).count();
        self.json.splice(start..end, VALUES[random.below(VALUES.len())].bytes());
    }

    fn damage(&mut self, random: &mut Random) {
        const BYTES: &[u8] = &[0, 1, 0x7F, 0x80, 0xFE, 0xFF];
        for _ in 0..1 + random.below(3) {
            let (at, byte) = (random.next() as usize, BYTES[random.below(BYTES.len())]);
            match random.below(8) {
                0 => {
                    let at = at % self.json.len();
                    self.json[at] = byte;
                }
                1 if !self.bin.is_empty() => self.bin.truncate(at % self.bin.len()),
                2..=4 if !self.bin.is_empty() => {
                    let at = at % self.bin.len();
                    let end = (at + 1 + random.below(4)).min(self.bin.len());
                    self.bin[at..end].fill(byte);
                }
                _ => self.change_number(random),
            }
        }
    }
}

/// Small GLBs: scenes of our own, and compressed ones of the shared collection where it is there.
fn seeds() -> Vec<Glb> {
    let mut paths: Vec<PathBuf> = ["plane_point", "plane_rect", "instances", "lit_room", "occluders"]
        .iter()
        .map(|name| workspace().join(format!("scenes/{name}.glb")))
        .collect();
    for name in [
        "playcanvas-heart_draco/heart_draco.glb",
        "gltf-transform-BoxMeshopt/BoxMeshopt.glb",
        "playcanvas-Lights/Lights.glb",
        "SimpleInstancing/SimpleInstancing.glb",
    ] {
        paths.extend(shared(&format!("assets/{name}")));
    }
    paths.iter().map(|path| Glb::split(&std::fs::read(path).expect("a scene"))).collect()
}

/// Faults that random damage seldom makes: each alone, refused where it lies.
#[test]
fn rare_faults_are_refused_by_place() {
    let _turn = turn();
    let bytes = std::fs::read(workspace().join("scenes/plane_point.glb")).expect("a scene");
    let Glb { json, bin } = Glb::split(&bytes);
    let whole: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
    let positions =
        whole["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().expect("an accessor") as usize;
    let view = whole["accessors"][positions]["bufferView"].as_u64().expect("a view") as usize;
    let refused = |change: &dyn Fn(&mut serde_json::Value)| {
        let mut document = whole.clone();
        change(&mut document);
        let bytes = Glb { json: document.to_string().into_bytes(), bin: bin.clone() }.join();
        attempt(&bytes, Path::new("rare.glb"), bytes.len() as u64).error.map(|error| error.object)
    };
    assert_eq!(refused(&|_| ()), None);
    let longer = refused(&|document| document["buffers"][0]["byteLength"] = (bin.len() + 1000).into());
    assert_eq!(longer.as_deref(), Some("buffers[0].byteLength"));
    let narrow = refused(&|document| document["bufferViews"][view]["byteStride"] = 4.into());
    assert_eq!(narrow, Some(format!("bufferViews[{view}].byteStride")));
    // The bits of a coordinate are no vertex.
    let indices = serde_json::json!({ "bufferView": view, "componentType": 5125 });
    let sparse = serde_json::json!({ "count": 1, "indices": indices, "values": { "bufferView": view } });
    let beyond = refused(&|document| document["accessors"][positions]["sparse"] = sparse.clone());
    assert_eq!(beyond, Some(format!("accessors[{positions}].sparse.indices")));
}

#[test]
fn mutated_scenes_are_loaded_or_refused() {
    let _turn = turn();
    let long = std::env::var_os("BAKE_LONG").is_some();
    let count = if long { 1_000_000 } else { 20_000 };
    let seeds = seeds();
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    let (mut loaded, mut slowest) = (0, 0.0f64);
    for i in 0..count {
        let mut glb = seeds[i % seeds.len()].clone();
        glb.damage(&mut Random(i as u64));
        let bytes = glb.join();
        let outcome = attempt(&bytes, Path::new("mutated.glb"), bytes.len() as u64);
        slowest = slowest.max(outcome.seconds);
        match outcome.error {
            None => loaded += 1,
            Some(error) => {
                let kind = format!("{:?}", error.fault);
                *kinds.entry(kind.split([' ', '(']).next().unwrap_or_default().to_owned()).or_default() += 1;
            }
        }
    }
    println!("{count} files: {loaded} loaded, slowest {slowest:.3} s, refused {kinds:?}");
    // The damage must be neither so gentle nor so coarse that the checks are not reached.
    assert!(loaded > count / 20 && loaded < count * 19 / 20, "{loaded} of {count} loaded");
    for kind in ["Json", "Reference", "Value", "Bounds", "Decode", "NoTriangles"] {
        assert!(kinds.contains_key(kind), "no {kind} among {kinds:?}");
    }
}
