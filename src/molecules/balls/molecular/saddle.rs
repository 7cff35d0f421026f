//! The saddle along an arc: what the probe sweeps while it touches two balls.
//!
//! In a half-plane at the axis through both centres, the probe is a disk at the distance `rho` from the axis.
//! The layer next to the arc is the part of the disk in the triangle of the probe's centre and the centres of
//! the balls. If `rho` is less than the radius of the probe, the axis cuts it: the saddle has two cusps
//! there.

use crate::balls::shares::Measure;

/// The layer of thickness `probe` next to an arc of one radian, in the direction from the circle's middle to
/// one of the centres, and the saddle that bounds it. `height` is the signed distance of the middle from this
/// centre, `square` that of the circle's radius.
///
/// It is odd in the height: what lies behind the other centre is subtracted from its part.
pub(super) fn half_layer(height: f64, square: f64, probe: f64) -> Measure {
    let rho = square.sqrt();
    let end = height.abs().atan2(rho);
    // Below the angle of the cusp, the axis ends the layer.
    let cusp = if rho < probe { ((probe - rho) * (probe + rho)).sqrt().atan2(rho) } else { 0.0 };
    let cusp = cusp.min(end);
    let (angle, sine) = (end - cusp, end.sin() - cusp.sin());
    let area = probe * (rho * angle - probe * sine);
    let volume = probe * probe * (rho * angle / 2.0 - probe * sine / 3.0) + rho.powi(3) * cusp.tan() / 6.0;
    let sign = if height < 0.0 { -1.0 } else { 1.0 };
    Measure { area: sign * area, volume: sign * volume }
}

/// The same for both centres: what each has of it. Where the middle of the circle lies behind one of them,
/// the other has all.
pub(super) fn layer(heights: [f64; 2], square: f64, probe: f64) -> [Measure; 2] {
    let mut halves = heights.map(|height| half_layer(height, square, probe));
    for end in 0..2 {
        if heights[end] < 0.0 {
            let behind = std::mem::take(&mut halves[end]);
            halves[1 - end].add(1.0, behind);
        }
    }
    halves
}
