//! Flags for experiments with the kernel.

use std::fmt;
use std::num::NonZeroUsize;

use clap::{Args, ValueEnum};

use super::selection::Switch;
use crate::tess3::{Arithmetic, Method, NO_EXPERIMENTS};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::order::{Curve, Sequence};

/// Builds without experiments hide these flags, and refuse them.
const HAS_EXPERIMENTS: bool = cfg!(feature = "experiments");

/// Seed unless another is given.
const SEED: u64 = 1;

/// How the kernel works. With exact arithmetic, the triangulation is always the same.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Experiments")]
pub(super) struct MethodFlags {
    /// Arithmetic of the predicates: float is that of the first tess3 (2003), whose tetrahedra fit together
    /// but may not be Delaunay
    #[arg(long, hide = !HAS_EXPERIMENTS, value_enum, default_value_t = ArithmeticFlag::Exact, value_name = "exact|float", hide_possible_values = true)]
    arithmetic: ArithmeticFlag,

    /// Order in which points are inserted: along a curve, or at random
    #[arg(long, hide = !HAS_EXPERIMENTS, value_enum, default_value_t = OrderFlag::Hilbert, value_name = "hilbert|morton|gray|row-major|random", hide_possible_values = true)]
    order: OrderFlag,

    /// How often insertion goes along the curve: in a few rounds, each with more of the points, or in one
    /// pass [default: rounds, with --arithmetic float pass]
    #[arg(long, hide = !HAS_EXPERIMENTS, value_enum, value_name = "rounds|pass", hide_possible_values = true)]
    sequence: Option<SequenceFlag>,

    /// Whether points that have more of their lowest bits in common are inserted first
    /// [default: off, with --arithmetic float on]
    #[arg(long, hide = !HAS_EXPERIMENTS, value_enum, value_name = "on|off", hide_possible_values = true)]
    bit_levels: Option<Switch>,

    /// Seed of --order random, and of the walks of --arithmetic float
    #[arg(long, hide = !HAS_EXPERIMENTS, value_name = "N", default_value_t = SEED)]
    seed: u64,

    /// Compare the signs of --arithmetic float with the exact ones and count the wrong ones; slow
    #[arg(long, hide = !HAS_EXPERIMENTS)]
    check_signs: bool,

    /// For --stats, measure the time for point location, predicates and update, which slows the run
    #[arg(long, hide = !HAS_EXPERIMENTS)]
    timed: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ArithmeticFlag {
    /// Signs are never wrong
    Exact,
    /// Rounded
    Float,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OrderFlag {
    /// Along Hilbert's curve
    Hilbert,
    /// Along the Z-order curve
    Morton,
    /// Along the curve of Gray codes
    Gray,
    /// Row by row through 8 x 8 x 8 boxes, and through each box again
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
    pub(super) fn method(&self, threads: NonZeroUsize) -> Result<Method> {
        if !HAS_EXPERIMENTS && !self.is_default() {
            return Err(Error::usage(NO_EXPERIMENTS));
        }
        let curve = match self.order {
            OrderFlag::Hilbert | OrderFlag::Random => Curve::Hilbert,
            OrderFlag::Morton => Curve::Morton,
            OrderFlag::Gray => Curve::Gray,
            OrderFlag::RowMajor => Curve::RowMajor,
        };
        let is_float = self.arithmetic == ArithmeticFlag::Float;
        let usual = if is_float { SequenceFlag::Pass } else { SequenceFlag::Rounds };
        let sequence = match (self.order, self.sequence.unwrap_or(usual)) {
            (OrderFlag::Random, _) => Sequence::Random { seed: self.seed },
            (_, SequenceFlag::Rounds) => Sequence::Rounds,
            (_, SequenceFlag::Pass) => Sequence::Pass,
        };
        let by_bit_levels = self.bit_levels.map_or(is_float, |switch| switch == Switch::On);
        let arithmetic = match (is_float, self.check_signs) {
            (true, check_signs) => Arithmetic::Float { check_signs },
            (false, false) => Arithmetic::Exact,
            (false, true) => return Err(Error::usage("--check-signs goes with --arithmetic float")),
        };
        let (seed, is_timed) = (self.seed, self.timed);
        Ok(Method { arithmetic, curve, sequence, by_bit_levels, seed, is_timed, threads })
    }

    fn is_default(&self) -> bool {
        let MethodFlags { arithmetic, order, sequence, bit_levels, seed, check_signs, timed } = *self;
        (arithmetic, order, seed) == (ArithmeticFlag::Exact, OrderFlag::Hilbert, SEED)
            && sequence.is_none()
            && bit_levels.is_none()
            && !(check_signs || timed)
    }
}

/// The options that affect the content of the outputs.
impl fmt::Display for MethodFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Ok(Method { arithmetic: Arithmetic::Float { .. }, curve, sequence, by_bit_levels, seed, .. }) =
            self.method(NonZeroUsize::MIN)
        else {
            return Ok(());
        };
        write!(f, " --arithmetic float ({curve:?}, {sequence:?}, bit levels {by_bit_levels}, seed {seed})")
    }
}
