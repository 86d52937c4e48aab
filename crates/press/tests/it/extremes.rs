//! Presses of all sizes and ratios: a displacement or curvature within its stated bound, or the named error.

mod fit;
mod half_space;
mod layer;
mod pictures;
mod shear;
mod skin;
