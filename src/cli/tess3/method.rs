//! Flags for experiments with the kernel.

use clap::{Args, ValueEnum};

use super::selection::Switch;
use crate::order::{Curve, Sequence};
use crate::tess3::Method;

/// How the kernel works. None of these changes the triangulation.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Experiments")]
pub(super) struct MethodFlags {
    /// Order in which points are inserted: along a curve, or at random
    #[arg(long, value_enum, default_value_t = OrderFlag::Hilbert, value_name = "hilbert|morton|gray|row-major|random", hide_possible_values = true)]
    order: OrderFlag,

    /// How often insertion goes along the curve: in a few rounds, each with more of the points, or in one pass
    #[arg(long, value_enum, default_value_t = SequenceFlag::Rounds, value_name = "rounds|pass", hide_possible_values = true)]
    sequence: SequenceFlag,

    /// Whether points that have more of their lowest bits in common are inserted first
    #[arg(long, value_enum, default_value_t = Switch::Off, value_name = "on|off", hide_possible_values = true)]
    bit_levels: Switch,

    /// Seed of --order random
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Measure the time for point location, predicates and update, too; it takes some itself
    #[arg(long)]
    timed: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OrderFlag {
    /// Along Hilbert's curve
    Hilbert,
    /// Along the Z-order curve
    Morton,
    /// Along the curve of Gray codes
    Gray,
    /// Row by row
    RowMajor,
    /// At random
    Random,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SequenceFlag {
    /// Every 512th point, then every 64th, every 8th, and the rest
    Rounds,
    /// One after the other
    Pass,
}

impl MethodFlags {
    pub(super) fn method(&self) -> Method {
        let curve = match self.order {
            OrderFlag::Hilbert | OrderFlag::Random => Curve::Hilbert,
            OrderFlag::Morton => Curve::Morton,
            OrderFlag::Gray => Curve::Gray,
            OrderFlag::RowMajor => Curve::RowMajor,
        };
        let sequence = match (self.order, self.sequence) {
            (OrderFlag::Random, _) => Sequence::Random { seed: self.seed },
            (_, SequenceFlag::Rounds) => Sequence::Rounds,
            (_, SequenceFlag::Pass) => Sequence::Pass,
        };
        Method { curve, sequence, by_bit_levels: self.bit_levels == Switch::On, is_timed: self.timed }
    }
}
