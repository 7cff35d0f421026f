//! What is ground: flags, and presets of them.

use clap::{Args, ValueEnum};

use crate::ground::Parameters;

/// What the ground is.
#[derive(Debug, Args)]
#[command(next_help_heading = "What is ground (lengths in metres)")]
pub(super) struct ParameterFlags {
    /// Parameters for a kind of country, which the flags below change
    #[arg(long, value_enum, value_name = "NAME")]
    preset: Option<Preset>,

    /// Side of the cells of which the lowest points count [default: 1]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    cell: Option<f64>,

    /// Radius of the largest buildings, half of their narrower side [default: 18]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    window: Option<f64>,

    /// Slope above which a rise within the window is an object, as rise over run [default: 0.2]
    #[arg(long, value_name = "SLOPE", allow_negative_numbers = true)]
    slope: Option<f64>,

    /// How far above the surface points of the ground lie where it is level [default: 0.3]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    threshold: Option<f64>,

    /// How much further for each unit of slope of the surface [default: 1.25]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    scaling: Option<f64>,

    /// Height above the first surface up to which steps are still ground [default: 0.4]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    rise: Option<f64>,

    /// How wide gaps of the ground may be that triangles bridge, as the radius of a circle without a point
    /// [default: 100]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    reach: Option<f64>,

    /// Depth from which a small pit is low noise [default: 2]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pit: Option<f64>,

    /// Height above the ground from which all points are high noise [default: 500]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    max_height: Option<f64>,

    /// Up to three points are high noise if there is no other for this length below them [default: 15]
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    noise_gap: Option<f64>,
}

/// The values of `--preset`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Preset {
    /// Plains: --slope 0.12 --window 30
    Flat,
    /// Towns with large halls on flat ground: --slope 0.15 --window 40
    Urban,
    /// Forests on hills, with few buildings: --slope 0.25 --window 12
    Forest,
    /// Steep rock without buildings: --slope 0.35 --window 12 --rise 0.5 --threshold 0.4
    Mountain,
}

impl ParameterFlags {
    /// All parameters.
    pub(super) fn parameters(&self) -> Parameters {
        let general = Parameters::default();
        let of_preset = match self.preset {
            None => general,
            Some(Preset::Flat) => Parameters { slope: 0.12, window: 30.0, ..general },
            Some(Preset::Urban) => Parameters { slope: 0.15, window: 40.0, ..general },
            Some(Preset::Forest) => Parameters { slope: 0.25, window: 12.0, ..general },
            Some(Preset::Mountain) => {
                Parameters { slope: 0.35, window: 12.0, step: 0.5, threshold: 0.4, ..general }
            }
        };
        Parameters {
            cell: self.cell.unwrap_or(of_preset.cell),
            window: self.window.unwrap_or(of_preset.window),
            slope: self.slope.unwrap_or(of_preset.slope),
            residual_slope: of_preset.residual_slope,
            step: self.rise.unwrap_or(of_preset.step),
            reach: self.reach.unwrap_or(of_preset.reach),
            threshold: self.threshold.unwrap_or(of_preset.threshold),
            scaling: self.scaling.unwrap_or(of_preset.scaling),
            pit: self.pit.unwrap_or(of_preset.pit),
            highest: self.max_height.unwrap_or(of_preset.highest),
            gap: self.noise_gap.unwrap_or(of_preset.gap),
        }
    }
}
