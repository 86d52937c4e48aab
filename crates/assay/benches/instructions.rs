//! Instructions of every hot path, by callgrind. `cargo xtask bench-check` compares them with
//! `baseline/instructions.csv`. Each path has run once before, so that tables and buffers are there.
#![allow(missing_docs, unreachable_pub)]

use gungraun::{
    Callgrind, EntryPoint, LibraryBenchmarkConfig, library_benchmark, library_benchmark_group, main,
};
use palpate_assay::hot::pictures::{Bodies, Step, half_spaces, layers};
use palpate_assay::hot::rolls::{Chart, Ep1, Model};
use palpate_assay::hot::{Hot, camera, patches, pictures, presses, rolls, texts};
use palpate_ep2::{Penalised, Quadric, TwoPass};
use palpate_press::Body;
use palpate_rolling::HeldAxis;
use palpate_sensing::PadLayout;

/// Trials of a block of the runner, four times.
const TRIALS: u64 = 4096;

/// Instructions alone: caches are not simulated.
fn counted() -> Callgrind {
    Callgrind::with_args(["--cache-sim=no"])
}

fn ready(path: anyhow::Result<Hot>) -> Hot {
    path.expect("a hot path is sound")
}

fn over_sphere(model: Model, angle_rad: f64) -> Hot {
    ready(rolls::sphere().and_then(|object| rolls::rolled(object, model, angle_rad)))
}

fn over_paraboloid(model: Model, angle_rad: f64) -> Hot {
    ready(rolls::paraboloid().and_then(|object| rolls::rolled(object, model, angle_rad)))
}

fn rk4(chart: Chart) -> Model {
    Model::Rk4 { steps: 16, chart }
}

fn dop853(chart: Chart) -> Model {
    Model::Dop853 {
        tolerance: 1e-10,
        chart,
    }
}

fn fitted(method: impl palpate_ep2::Method + 'static) -> Hot {
    ready(patches::fitted(method, &patches::few(0)))
}

fn mapped(method: &dyn palpate_ep2::Method) -> Hot {
    ready(patches::mapped(method, &patches::few(0), 30))
}

fn many() -> Hot {
    let method = Penalised {
        intervals: Some(6),
        ..Penalised::default()
    };
    ready(patches::fitted(method, &patches::many(10_000)))
}

fn half_space() -> Body {
    Body::half_space(0.5, 2.0).expect("a body")
}

fn layer() -> Body {
    Body::bonded_layer(5.0, 2.0).expect("a body")
}

fn solved_layer() -> Body {
    Body::solved_layer(5.0, 2.0).expect("a body")
}

#[library_benchmark]
#[bench::closed_form(over_sphere(Model::ClosedForm, 0.1))]
#[bench::meridian(over_paraboloid(Model::Meridian, 0.1))]
#[bench::rk4_chart_free(over_paraboloid(rk4(Chart::Free), 0.1))]
#[bench::rk4_in_charts(over_paraboloid(rk4(Chart::Montana(HeldAxis::Transported)), 0.1))]
#[bench::dop853_chart_free(over_paraboloid(dop853(Chart::Free), 6.0))]
#[bench::dop853_in_charts(over_paraboloid(dop853(Chart::Montana(HeldAxis::Transported)), 6.0))]
#[bench::touch_of_a_round_tip(ready(rolls::touches(16)))]
fn rolling(mut path: Hot) -> Hot {
    path();
    path
}

#[library_benchmark]
#[bench::square_pads(ready(rolls::pads(PadLayout::Square, 1000)))]
#[bench::uniform_pads(ready(rolls::pads(PadLayout::Uniform, 1000)))]
fn sensing(mut path: Hot) -> Hot {
    path();
    path
}

#[library_benchmark]
#[bench::ep1(ready(rolls::trials(Ep1::UNIFORM, TRIALS)))]
#[bench::ep1_on_pads(ready(rolls::trials(Ep1::PADS, TRIALS)))]
fn trials(mut path: Hot) -> Hot {
    path();
    path
}

// The runner works on a thread of its own: its blocks are counted, those of the first run too.
#[library_benchmark(config = LibraryBenchmarkConfig::default().tool(
    counted().entry_point(EntryPoint::Custom("*Part*run_block*".to_owned()))
))]
#[bench::statistics_alone(ready(rolls::statistics_alone(TRIALS)))]
fn runner(mut path: Hot) -> Hot {
    path();
    path
}

#[library_benchmark]
#[bench::quadric_fit(fitted(Quadric::default()))]
#[bench::penalised_fit(fitted(Penalised::default()))]
#[bench::penalised_estimate(ready(patches::estimated(Penalised::default(), &patches::few(0))))]
#[bench::two_pass_fit(fitted(TwoPass::default()))]
#[bench::quadric_map(mapped(&Quadric::default()))]
#[bench::penalised_map(mapped(&Penalised::default()))]
#[bench::ten_thousand_contacts(many())]
fn ep2(mut path: Hot) -> Hot {
    path();
    path
}

#[library_benchmark]
#[bench::half_space_at_77_markers(ready(presses::moved(half_space())))]
#[bench::layer_at_77_markers(ready(presses::moved(layer())))]
#[bench::solved_layer_at_77_markers(ready(presses::moved(solved_layer())))]
#[bench::half_space_fit(ready(presses::fitted(half_space())))]
#[bench::layer_fit(ready(presses::fitted(layer())))]
fn press(mut path: Hot) -> Hot {
    path();
    path
}

fn imaged(bodies: Bodies, step: Step) -> Hot {
    ready(pictures::worked(bodies, step))
}

#[library_benchmark]
#[bench::rest(imaged(layers, Step::Rest))]
#[bench::half_space_fit(imaged(half_spaces, Step::Fit))]
#[bench::layer_fit(imaged(layers, Step::Fit))]
#[bench::layer_doubts(imaged(layers, Step::Doubts))]
fn images(mut path: Hot) -> Hot {
    path();
    path
}

#[library_benchmark]
#[bench::projected(ready(camera::projected()))]
#[bench::rendered_640_px(ready(camera::rendered(640)))]
#[bench::find_640_px(ready(camera::found(640)))]
#[bench::match_77_markers(ready(camera::matched(640)))]
fn sight(mut path: Hot) -> Hot {
    path();
    path
}

#[library_benchmark]
#[bench::formula(ready(texts::evaluated(100)))]
#[bench::config(ready(texts::parsed()))]
fn text(mut path: Hot) -> Hot {
    path();
    path
}

library_benchmark_group!(
    name = hot_paths,
    benchmarks = [
        rolling, sensing, trials, runner, ep2, press, images, sight, text
    ]
);
main!(
    config = LibraryBenchmarkConfig::default().tool(counted()),
    library_benchmark_groups = hot_paths
);
