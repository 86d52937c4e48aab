//! A drawn figure, as SVG and as PNG.

#[cfg(feature = "png")]
use super::lettering::{FONTS, runs};
#[cfg(feature = "png")]
use crate::ReportError;
#[cfg(feature = "png")]
use resvg::{tiny_skia, usvg};
#[cfg(feature = "png")]
use std::sync::{Arc, LazyLock};

/// Figure as it is drawn.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Name of its files, without an ending.
    pub name: String,
    /// Title, which also stands in the picture.
    pub title: String,
    /// The picture as SVG. Its text is text, which a viewer sets in its own sans-serif.
    pub svg: String,
}

#[cfg(feature = "png")]
static LETTERING: LazyLock<Arc<usvg::fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = usvg::fontdb::Database::new();
    FONTS
        .iter()
        .for_each(|font| fonts.load_font_data(font.to_vec()));
    let family = fonts.faces().next().and_then(|face| face.families.first());
    if let Some((family, _)) = family.cloned() {
        fonts.set_sans_serif_family(family);
    }
    Arc::new(fonts)
});

#[cfg(feature = "png")]
impl Figure {
    /// Bytes of the picture as PNG: the SVG, in pixels of its own size and in the built-in fonts.
    ///
    /// # Errors
    /// The SVG has been changed, and is none or too large.
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        let failed = |message: String| ReportError::Draw {
            path: format!("{}.png", self.name).into(),
            message,
        };
        let options = usvg::Options {
            fontdb: LETTERING.clone(),
            font_resolver: usvg::FontResolver {
                select_font: usvg::FontResolver::default_font_selector(),
                select_fallback: Box::new(|_, _, _| None),
            },
            ..usvg::Options::default()
        };
        let svg = self.with_fonts();
        let tree = usvg::Tree::from_str(&svg, &options).map_err(|e| failed(e.to_string()))?;
        let size = tree.size().to_int_size();
        let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height())
            .ok_or_else(|| failed("the picture is too large".to_owned()))?;
        resvg::render(
            &tree,
            tiny_skia::Transform::identity(),
            &mut pixels.as_mut(),
        );
        pixels.encode_png().map_err(|e| failed(e.to_string()))
    }

    /// The SVG with the font of each letter that the first lacks: left to find it, the rasteriser would set all the letters
    /// around it in that font too.
    fn with_fonts(&self) -> String {
        let families: Vec<&str> = LETTERING
            .faces()
            .filter_map(|face| Some(face.families.first()?.0.as_str()))
            .collect();
        let mut svg = String::with_capacity(self.svg.len());
        for line in self.svg.lines() {
            let is_text = !line.starts_with('<');
            for (font, letters) in runs(line) {
                match families.get(font) {
                    Some(family) if is_text && font > 0 => {
                        svg += &format!("<tspan font-family=\"{family}\">{letters}</tspan>");
                    }
                    _ => svg += letters,
                }
            }
            svg.push('\n');
        }
        svg
    }
}
