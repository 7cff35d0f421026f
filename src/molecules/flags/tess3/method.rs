//! Flags for experiments with the kernel.

use std::fmt;
use std::num::NonZeroUsize;

use clap::Args;

use super::selection::SWITCH;
use crate::tess3::{Arithmetic, Method};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::order::{Curve, Sequence};
use spmesh_shell::{Names, named};

/// How the kernel works. With exact arithmetic, the triangulation is always the same.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Experiments")]
pub(super) struct MethodFlags {
    /// Arithmetic of the predicates: float is that of the first tess3 (2003), whose tetrahedra fit together
    /// but may not be Delaunay
    #[arg(long, hide_short_help = true, value_name = "exact|float", hide_possible_values = true)]
    #[arg(default_value = "exact", value_parser = named(ARITHMETICS))]
    arithmetic: Arithmetic,

    /// Order in which points are inserted: along a curve, or at random
    #[arg(
        long,
        hide_short_help = true,
        value_name = "hilbert|morton|gray|row-major|random",
        hide_possible_values = true
    )]
    #[arg(default_value = "hilbert", value_parser = named(ORDERS))]
    order: Order,

    /// How often insertion goes along the curve: in a few rounds, each with more of the points, or in one
    /// pass [default: rounds, with --arithmetic float pass]
    #[arg(long, hide_short_help = true, value_name = "rounds|pass", hide_possible_values = true)]
    #[arg(value_parser = named(SEQUENCES))]
    sequence: Option<Sequence>,

    /// Whether points that have more of their lowest bits in common are inserted first
    /// [default: off, with --arithmetic float on]
    #[arg(long, hide_short_help = true, value_name = "on|off", hide_possible_values = true)]
    #[arg(value_parser = named(SWITCH))]
    bit_levels: Option<bool>,

    /// Seed of --order random, and of the walks of --arithmetic float
    #[arg(long, hide_short_help = true, value_name = "N", default_value_t = 1)]
    seed: u64,

    /// Compare the signs of --arithmetic float with the exact ones and count the wrong ones; slow
    #[arg(long, hide_short_help = true)]
    check_signs: bool,

    /// For --stats, measure the time for point location, predicates and update, which slows the run
    #[arg(long, hide_short_help = true)]
    timed: bool,
}

const ARITHMETICS: Names<Arithmetic> =
    &[("exact", Arithmetic::Exact), ("float", Arithmetic::Float { check_signs: false })];

/// A curve; `None` for a random order.
type Order = Option<Curve>;

const ORDERS: Names<Order> = &[
    ("hilbert", Some(Curve::Hilbert)),
    ("morton", Some(Curve::Morton)),
    ("gray", Some(Curve::Gray)),
    ("row-major", Some(Curve::RowMajor)),
    ("random", None),
];

const SEQUENCES: Names<Sequence> = &[("rounds", Sequence::Rounds), ("pass", Sequence::Pass)];

impl MethodFlags {
    pub(super) fn method(&self, threads: NonZeroUsize) -> Result<Method> {
        let is_float = self.arithmetic != Arithmetic::Exact;
        let usual = if is_float { Sequence::Pass } else { Sequence::Rounds };
        let sequence = match self.order {
            None => Sequence::Random { seed: self.seed },
            Some(_) => self.sequence.unwrap_or(usual),
        };
        let curve = self.order.unwrap_or_default();
        let by_bit_levels = self.bit_levels.unwrap_or(is_float);
        let arithmetic = match (is_float, self.check_signs) {
            (true, check_signs) => Arithmetic::Float { check_signs },
            (false, false) => Arithmetic::Exact,
            (false, true) => return Err(Error::usage("--check-signs goes with --arithmetic float")),
        };
        let (seed, is_timed) = (self.seed, self.timed);
        Ok(Method { arithmetic, curve, sequence, by_bit_levels, seed, is_timed, threads })
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
