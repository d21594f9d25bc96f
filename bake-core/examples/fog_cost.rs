//! What fog adds to a bake: one scene baked in turns without air, with fog by `grid` and by `tables`, with and without rays on a
//! surface's own plane, and by `walk`, at equal texel samples in one run. `fog_cost [SCENE [PAGE_SIZE [SAMPLES [TURNS [WAYS]]]]]`, ways by commas.
//!
//! Times are processor seconds of all threads, the least of all turns. `prepare` is what a scene takes once: the light grid,
//! or the factors of tables. Cost at equal noise is error² × `trace`, as `prepare` does not grow with samples.

use bake_core::job::Job;
use bake_core::plan::Plan;
use bake_core::progress::{Progress, Silent};
use bake_core::settings::{self, EffectName, Mode, Scatter, Settings};
use bake_core::solve;
use bake_core::trace::Tracer;
use cpu_time::ProcessTime;
use std::error::Error;
use std::path::Path;
use std::sync::Mutex;

/// Fog by extinction (1/m, or over the scene's longest side) and albedo.
const AIRS: [(&str, Air, f64); 3] = [
    ("haze of 0.05 per metre, albedo 0.9", Air::PerMetre(0.05), 0.9),
    ("optical size 1, albedo 1", Air::AcrossScene(1.0), 1.0),
    ("optical size 3, albedo 1", Air::AcrossScene(3.0), 1.0),
];

#[derive(Clone, Copy)]
enum Air {
    PerMetre(f64),
    AcrossScene(f64),
}

/// One way to bake.
struct Way {
    name: &'static str,
    plan: Plan,
    spent: Spent,
}

/// Least of all turns; errors are the same in each.
#[derive(Clone, Copy)]
struct Spent {
    prepare: f64,
    trace: f64,
    error: f64,
}

impl Spent {
    const NONE: Self = Self { prepare: f64::INFINITY, trace: f64::INFINITY, error: 0.0 };

    /// Time for an error of 1.
    fn cost(&self) -> f64 {
        self.error * self.error * self.trace
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |i: usize, usual: &str| arguments.get(i).map_or(usual, String::as_str).to_owned();
    let file = argument(0, "scenes/hall.glb");
    let file = Path::new(&file);
    let (page_size, samples, turns) =
        (argument(1, "256").parse()?, argument(2, "32").parse()?, argument(3, "3").parse::<usize>()?);
    let sidecar = settings::sidecar(file);
    let of_scene = if sidecar.exists() { settings::read(&sidecar)? } else { Settings::default() };
    let settings = Settings { page_size, samples: Some(samples), max_pages: Some(1), ..of_scene };
    let ways = arguments.get(4).map(|names| names.split(',').collect::<Vec<_>>());
    let wanted = |name: &str| name == "no air" || ways.as_ref().is_none_or(|names| names.contains(&name));
    for air in AIRS {
        measure(file, &settings, air, turns, &wanted)?;
    }
    Ok(())
}

fn measure(
    file: &Path,
    settings: &Settings,
    (name, air, albedo): (&str, Air, f64),
    turns: usize,
    wanted: &dyn Fn(&str) -> bool,
) -> Result<(), Box<dyn Error>> {
    let job = Job::prepare(file, settings.clone(), &Silent)?;
    let [low, high] = job.scene.bounds();
    let sigma_t = match air {
        Air::PerMetre(sigma_t) => sigma_t,
        Air::AcrossScene(size) => size / f64::from((high - low).max_element()),
    };
    let fog = fog(sigma_t, albedo);
    let foggy = Job::prepare(file, Settings { media: Some(vec![fog]), ..settings.clone() }, &Silent)?;
    let tracer = Tracer::new(&job.scene);
    let way = |name, job: &Job, mode, force: &[(EffectName, bool)]| {
        let settings = Settings { mode, force_effect: force.iter().copied().collect(), ..job.settings.clone() };
        let plan = Plan::derive(&tracer, &job.air, &settings, &job.atlas, rayon::current_num_threads())?;
        Ok::<_, Box<dyn Error>>(Way { name, plan, spent: Spent::NONE })
    };
    let own_plane = |on| [(EffectName::OwnPlane, on)];
    let mut ways = vec![
        way("no air", &job, Mode::Auto, &[])?,
        way("auto", &foggy, Mode::Auto, &[])?,
        way("tables", &foggy, Mode::Tables, &own_plane(true))?,
        way("tables without own plane", &foggy, Mode::Tables, &own_plane(false))?,
        way("walk", &foggy, Mode::Walk, &[])?,
    ];
    ways.retain(|way| wanted(way.name));
    for _ in 0..turns {
        for way in &mut ways {
            let Spent { prepare, trace, error } = bake(&tracer, &foggy, &way.plan)?;
            let least = &mut way.spent;
            *least = Spent { prepare: least.prepare.min(prepare), trace: least.trace.min(trace), error };
        }
    }
    print(name, sigma_t, &ways);
    Ok(())
}

fn fog(sigma_t: f64, albedo: f64) -> settings::Medium {
    settings::Medium {
        name: "fog".into(),
        bounds: settings::Bounds::Scene,
        density: settings::Density::Uniform,
        scatter: Scatter::Look { mean_free_path_m: sigma_t.recip() as f32, albedo: [albedo as f32; 3] },
        phase: settings::Phase::Isotropic,
    }
}

/// Learns when tracing begins: all before is preparation.
struct Watch {
    start: ProcessTime,
    prepared: Mutex<f64>,
}

impl Progress for Watch {
    fn stage(&self, name: &str, _units: u64) {
        if name == "trace" {
            *self.prepared.lock().expect("nobody panics") = self.start.elapsed().as_secs_f64();
        }
    }
    fn expect(&self, _units: u64) {}
    fn advance(&self, _units: u64) {}
    fn is_cancelled(&self) -> bool {
        false
    }
}

fn bake(tracer: &Tracer, job: &Job, plan: &Plan) -> Result<Spent, Box<dyn Error>> {
    let watch = Watch { start: ProcessTime::now(), prepared: Mutex::new(0.0) };
    let lightmap = solve::lightmap(tracer, &plan.simulated.media, &job.atlas, &plan.solver, &watch)?;
    let (all, prepare) = (watch.start.elapsed().as_secs_f64(), *watch.prepared.lock().expect("nobody panics"));
    Ok(Spent { prepare, trace: all - prepare, error: f64::from(lightmap.reports[0].error) })
}

fn print(name: &str, sigma_t: f64, ways: &[Way]) {
    let [vacuum, .., last] = ways else { return };
    println!("{name} ({sigma_t:.4} per metre)");
    println!(
        "  way                       prepare    trace  over no air    error  at equal noise over no air  over {}",
        last.name
    );
    for Way { name, plan, spent } in ways {
        let mode = plan.mode.as_ref().map_or("-", |choice| choice.mode.name());
        println!(
            "  {name:24} {:7.2} s {:6.2} s {:10.2} x {:6.2} % {:24.2} x {:12.4} x  {mode}",
            spent.prepare,
            spent.trace,
            spent.trace / vacuum.spent.trace,
            100.0 * spent.error,
            spent.cost() / vacuum.spent.cost(),
            spent.cost() / last.spent.cost(),
        );
    }
}
