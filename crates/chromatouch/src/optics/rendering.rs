//! Renders the markers as frames of pixels.

use image::RgbImage;
use palpate_sensing::{Channel, Stream};

use super::{MarkerMotion, Optics, OpticsError};

mod blemishes;
mod marker_raster;
mod row;

pub use blemishes::{Blemishes, Seams};

use blemishes::Blur;
use marker_raster::MarkerRaster;
use row::{Row, Rows};

impl Optics {
    /// Renders an anti-aliased frame of the markers, with 8 bits per channel and levels that are linear in the light. A
    /// marker whose motion is `None` is missing. The pixel noise depends only on `noise`, which is a seed and the number
    /// of the frame. There is no noise if `noise` is `None` or the standard deviation of the noise is 0.
    ///
    /// ```
    /// use palpate_chromatouch::{
    ///     Blemishes, Camera, Colours, DiscDepths, Discs, Lens, MarkerArray, Optics,
    /// };
    ///
    /// let discs = Discs { magenta: 2.0, yellow: 2.0 };
    /// let depths = DiscDepths { magenta: 3.0, yellow: 1.0 };
    /// let array = MarkerArray::new(20.0, &[], discs, depths)?;
    /// let camera = Camera::new(Lens::Fisheye, 64, 70.0)?;
    /// let optics = Optics::new(array, camera, Colours::default(), Blemishes::default())?;
    /// // Without markers a frame shows the lit white layer, 0.96 of full scale, and the white surround.
    /// let frame = optics.render(&[], None)?;
    /// assert_eq!(frame.get_pixel(32, 32).0, [245; 3]);
    /// assert_eq!(frame.get_pixel(0, 0).0, [255; 3]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Optics::project`].
    pub fn render(
        &self,
        motions: &[Option<MarkerMotion>],
        noise: Option<(u64, u64)>,
    ) -> Result<RgbImage, OpticsError> {
        let mut markers = Vec::new();
        for sight in self.sights(motions)? {
            if let Some(sight) = sight? {
                markers.extend(MarkerRaster::new(&self.camera, &sight));
            }
        }
        markers.sort_by_key(|marker: &MarkerRaster| marker.rows.start);
        palpate_statistics::work::painted(1);
        let side = self.camera.size_px();
        let size = side as usize;
        let mut frame = RgbImage::new(side, side);
        let noise = noise.filter(|_| self.blemishes.pixel_std > 0.0);
        let mut noise = noise.map(|(seed, frame)| Stream::new(seed, frame, Channel::Pixel));
        let mut rows = Rows::new(self, &markers);
        let mut blur = Blur::new(self.blemishes.blur_px, size);
        let mut row = Row::new(size);
        for (number, bytes) in frame.chunks_exact_mut(3 * size).enumerate() {
            match &mut blur {
                None => rows.paint(number, &mut row),
                Some(blur) => blur.blur(number, &mut row, |number, row| rows.paint(number, row)),
            }
            if let Some(stream) = &mut noise {
                row.add_noise(rows.inside(number), self.blemishes.pixel_std as f32, stream);
            }
            row.write(bytes);
        }
        Ok(frame)
    }
}
