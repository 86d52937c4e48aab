//! Hue of a colour.

/// Smallest HSV saturation of a pixel that counts in a mean hue.
const MIN_SATURATION: f64 = 0.25;

/// Hue of a colour in turns, from 0 to below 1, by the hexagonal formula of HSV. The hue of a grey is 0.
///
/// ```
/// use palpate_statistics::hue_turns;
///
/// assert_eq!(hue_turns([1.0, 1.0, 0.0]), 1.0 / 6.0);
/// // Just below red, the start of the next turn.
/// assert_eq!(hue_turns([1.0, 0.0, 1e-30]), 0.0);
/// ```
pub fn hue_turns([red, green, blue]: [f64; 3]) -> f64 {
    let most = red.max(green).max(blue);
    let chroma = most - red.min(green).min(blue);
    let sixths = if chroma == 0.0 {
        0.0
    } else if most == red {
        (green - blue) / chroma
    } else if most == green {
        2.0 + (blue - red) / chroma
    } else {
        4.0 + (red - green) / chroma
    };
    let turns = sixths / 6.0;
    let turns = if turns < 0.0 { turns + 1.0 } else { turns };
    // Rounding can make the hue exactly 1 turn. This is the same hue as 0.
    if turns < 1.0 { turns } else { 0.0 }
}

/// Hue of a colour, in turns, if the colour's HSV saturation is above 1/4; `None` for a paler colour. A mean hue uses
/// only colours for which the result is not `None`.
///
/// ```
/// use palpate_statistics::saturated_hue;
///
/// assert_eq!(saturated_hue([1.0, 0.7, 0.7]), Some(0.0));
/// assert_eq!(saturated_hue([1.0, 0.8, 0.8]), None);
/// ```
pub fn saturated_hue(colour: [f64; 3]) -> Option<f64> {
    let [red, green, blue] = colour;
    let most = red.max(green).max(blue);
    let chroma = most - red.min(green).min(blue);
    (chroma > MIN_SATURATION * most).then(|| hue_turns(colour))
}
