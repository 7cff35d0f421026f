//! Selects the points of an input.

use super::sample::choose;
use super::scan::Supply;
use super::{Selected4, Selection, Share, too_many};
use spmesh_core::error::{Error, ErrorKind, Result};
use spmesh_core::limits::{DIAGRAM4_POINT_BYTES, POINTS4_MAX};
use spmesh_core::system::memory_limit;
use spmesh_model::cells4::Point4;

/// The selected points, in the order of the input.
///
/// # Errors
/// As [`Supply::scan`]; usage, if the selection does not suit the input or selects too many points.
pub(super) fn select(supply: &Supply, selection: &Selection) -> Result<Selected4> {
    check(supply, selection)?;
    if let Some(points) = count_before(supply, selection) {
        check_count(points)?;
    }
    match (supply, selection.share) {
        (Supply::Grid(lattice), Some(share)) if selection.condition.is_none() => {
            let sites = lattice.sites();
            let chosen = choose(sites, share.of(sites)?, selection.seed)?;
            let points = chosen.into_iter().map(|number| lattice.site(number)).collect();
            Ok(Selected4 { points, values: None, name: String::new(), sites, warnings: Vec::new() })
        }
        (_, Some(share)) => select_at_random(supply, selection, share),
        (_, None) => Ok(Intake::of(supply, selection, |_| true)?.finish(selection)),
    }
}

fn check(supply: &Supply, selection: &Selection) -> Result<()> {
    if supply.has_values() {
        return Ok(());
    }
    if selection.condition.as_ref().is_some_and(|condition| condition.needs_value()) {
        return Err(Error::usage("points have no values here: --where can only compare x, y, z and t"));
    }
    Ok(())
}

/// The number of points that will be selected, if it is known before any is read or generated.
fn count_before(supply: &Supply, selection: &Selection) -> Option<u64> {
    let sites = match supply {
        Supply::Grid(lattice) => lattice.sites(),
        Supply::Volume(volume) if selection.keep_nan || volume.data.sample.is_integer() => {
            volume.lattice.sites()
        }
        _ => return None,
    };
    match (&selection.condition, selection.share) {
        (None, None) => Some(sites),
        _ => None,
    }
}

/// Refuses more points than are read, and more than the memory can hold the diagram of.
fn check_count(points: u64) -> Result<()> {
    if points > POINTS4_MAX {
        return Err(too_many("points", points, POINTS4_MAX, REMEDY));
    }
    let needed = points * DIAGRAM4_POINT_BYTES;
    match memory_limit().filter(|&limit| needed > limit) {
        Some(limit) => {
            let [needed, limit] = [needed, limit].map(|bytes| bytes.div_ceil(1 << 20));
            let message = format!(
                "not enough memory: the diagram of {points} points takes at least {needed} MiB, there are {limit}: \
                 {REMEDY}"
            );
            Err(Error::new(ErrorKind::Memory, message))
        }
        None => Ok(()),
    }
}

const REMEDY: &str = "choose some of them with --where, --sample or --count";

/// Takes two passes: the number of wanted points must be known before some of them are chosen.
fn select_at_random(supply: &Supply, selection: &Selection, share: Share) -> Result<Selected4> {
    let mut wanted = 0;
    supply.scan(&mut |point, value| {
        wanted += u64::from(is_wanted(selection, &point, value));
        Ok(())
    })?;
    let mut chosen = choose(wanted, share.of(wanted)?, selection.seed)?.into_iter().peekable();
    let intake = Intake::of(supply, selection, |number| chosen.next_if_eq(&number).is_some())?;
    if chosen.peek().is_some() || intake.wanted != wanted {
        // Only another process can have changed the input.
        return Err(Error::malformed("has changed while it was read: read it again"));
    }
    Ok(intake.finish(selection))
}

fn is_wanted(selection: &Selection, point: &Point4, value: Option<f64>) -> bool {
    let holds = |condition: &super::Condition| condition.holds(point, value.unwrap_or(f64::NAN));
    (selection.keep_nan || !value.is_some_and(f64::is_nan)) && selection.condition.as_ref().is_none_or(holds)
}

/// Collects points.
#[derive(Default)]
struct Intake {
    points: Vec<Point4>,
    values: Option<Vec<f64>>,
    sites: u64,
    wanted: u64,
    missing: u64,
    warning: Option<String>,
}

impl Intake {
    /// Keeps those wanted points for whose index among the wanted points `keeps` returns true.
    fn of(supply: &Supply, selection: &Selection, mut keeps: impl FnMut(u64) -> bool) -> Result<Intake> {
        let values = supply.has_values().then(Vec::new);
        let mut intake = Intake { values, ..Intake::default() };
        let warning = supply.scan(&mut |point, value| {
            intake.sites += 1;
            intake.missing += u64::from(value.is_some_and(f64::is_nan));
            if !is_wanted(selection, &point, value) {
                return Ok(());
            }
            intake.wanted += 1;
            if keeps(intake.wanted - 1) { intake.push(point, value) } else { Ok(()) }
        })?;
        Ok(Intake { warning, ..intake })
    }

    fn push(&mut self, point: Point4, value: Option<f64>) -> Result<()> {
        let count = self.points.len() as u64;
        if count == POINTS4_MAX {
            return Err(too_many("points", count + 1, POINTS4_MAX, REMEDY));
        }
        let no_memory = |_| Error::new(ErrorKind::Memory, format!("not enough memory for {count} points"));
        self.points.try_reserve(1).map_err(no_memory)?;
        self.points.push(point);
        if let (Some(values), Some(value)) = (&mut self.values, value) {
            values.try_reserve(1).map_err(no_memory)?;
            values.push(value);
        }
        Ok(())
    }

    fn finish(self, selection: &Selection) -> Selected4 {
        let Intake { points, values, sites, wanted, missing, warning } = self;
        let mut warnings = Vec::from_iter(warning);
        if missing > 0 && !selection.keep_nan {
            warnings.push(format!("{missing} of {sites} points have no value (NaN) and are left out"));
        }
        if points.is_empty() {
            let why = if wanted == 0 { "none fulfils what is asked for" } else { "too few are chosen" };
            warnings.push(format!("no point is left of {sites}: {why}"));
        }
        Selected4 { points, values, name: String::new(), sites, warnings }
    }
}
