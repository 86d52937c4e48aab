//! Computations that a rung needs for the truth of a scene, and nothing else.

use anyhow::{Result, bail};
use palpate_chromatouch::Layout;
use palpate_press::{Body, Markers, Skin};
use palpate_scene::Scenes;
use palpate_scene::{GlideScene, Rung, Scene};
use palpate_study::config::{
    ModelConfig, PressConfig, PressModelConfig, PressObjectConfig, PressProbeConfig, SceneConfig,
    Study,
};

/// Repeatable computation that returns its number of contacts or markers.
pub(super) type Computation = Box<dyn FnMut() -> Result<usize>>;

/// The truth of the first cell's scene on a rung.
pub(super) fn truth(study: &Study, rung: &Rung) -> Result<Computation> {
    let scene = &study.config.scene;
    match (scene.with_model(&rung.model), &rung.model) {
        (Some(SceneConfig::Roll(_)), _) => rolls(study.with_model(0, rung)?),
        (Some(SceneConfig::Glide(config)), _) => {
            let glider = GlideScene::glider(&config)
                .map_err(|error| anyhow::anyhow!("{}", error.message))?;
            Ok(Box::new(move || {
                match GlideScene::follow(&glider, &config) {
                    Ok(touches) => Ok(touches.len()),
                    Err(error) => bail!("{}: {}", error.path, error.message),
                }
            }))
        }
        (Some(SceneConfig::Press(config)), ModelConfig::Press(model)) => press(&config, model),
        _ => bail!("{} touches nothing", rung.name),
    }
}

/// All probes follow their commands.
fn rolls(scene: Scene) -> Result<Computation> {
    let Scene::Roll(scene) = scene else {
        bail!("no roll");
    };
    let rolls = scene.noiseless();
    Ok(Box::new(move || {
        for motions in &rolls {
            std::hint::black_box(scene.roller().shift(motions)?);
        }
        Ok(rolls.len())
    }))
}

/// A contact, and how it moves the markers.
fn press(config: &PressConfig, model: &PressModelConfig) -> Result<Computation> {
    let (body, markers) = (body(config, model)?, markers(config)?);
    let object_curvature = curvature(config);
    let indentation = config.motion.indentation;
    Ok(Box::new(move || {
        let contact = markers
            .skin()
            .contact(&body, object_curvature, indentation)?;
        Ok(std::hint::black_box(markers.displacements(&contact, [0.0; 2])).len())
    }))
}

/// Soft body that a rung computes with.
pub(super) fn body(config: &PressConfig, model: &PressModelConfig) -> Result<Body> {
    let PressProbeConfig::MarkerSphere { marker_depth, .. } = config.probe;
    Ok(match *model {
        PressModelConfig::Hertz { poisson } => Body::hertz(poisson)?,
        PressModelConfig::HalfSpace { poisson } => Body::half_space(poisson, marker_depth)?,
        PressModelConfig::BondedLayer { thickness } => Body::solved_layer(thickness, marker_depth)?,
        PressModelConfig::Auto { .. } => bail!("auto is no rung"),
    })
}

/// The object's curvature.
pub(super) fn curvature(config: &PressConfig) -> f64 {
    match config.object {
        PressObjectConfig::Sphere { radius } => radius.recip(),
        PressObjectConfig::Dish { radius } => -radius.recip(),
        PressObjectConfig::Plane {} => 0.0,
    }
}

/// The published sensor's.
pub(super) fn markers(config: &PressConfig) -> Result<Markers> {
    let PressProbeConfig::MarkerSphere { radius, .. } = config.probe;
    let places = Layout::published().places(radius)?;
    Ok(Markers::new(Skin::new(radius)?, &places)?)
}
