//! Configs for small studies of presses.

/// Label, config and effective radius of each object. The effective radius is for a sensor of radius 20 mm.
pub(crate) const OBJECTS: [(&str, &str, f64); 3] = [
    (
        "dish of 80 mm",
        "kind = \"dish\", radius = 80.0",
        80.0 / 3.0,
    ),
    ("plane", "kind = \"plane\"", 20.0),
    ("ball of 80 mm", "kind = \"sphere\", radius = 80.0", 16.0),
];

/// Config of presses in millimetres that sweeps objects and estimators. `rest` is added to the config.
pub(crate) fn config(claims: &str, rest: &str) -> String {
    let objects = OBJECTS.map(|(label, shape, _)| format!("{{ label = \"{label}\", {shape} }}"));
    format!(
        "name = \"study\"\ntitle = \"A question?\"\nlength_unit = \"mm\"\nclaims = {claims}\n\
         [scene]\nkind = \"press\"\nprobe = {{ kind = \"marker-sphere\", radius = 20.0 }}\n\
         object = {{ kind = \"plane\" }}\nmotion = {{ indentation = 1.0 }}\n\
         model = {{ kind = \"half-space\" }}\nestimator = {{ kind = \"half-space\" }}\n\
         [[sweep]]\npath = \"scene.object\"\nvalues = [{}]\n\
         [[sweep]]\npaths = [\"scene.estimator\"]\nvalues = [[{{ label = \"half-space\", kind = \"half-space\" }}], \
         [{{ label = \"gaussian\", kind = \"gaussian\", c = 1.0 }}], \
         [{{ label = \"calibrated gaussian\", kind = \"gaussian\" }}]]\n{rest}",
        objects.join(", ")
    )
}
