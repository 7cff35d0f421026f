//! The coordinate reference system of a LAS file, and that of several files.

use crate::crs::{System, differences};
use spmesh_base::error::{Error, Result};
use spmesh_base::limits::CRS_LEN_MAX;
use spmesh_stream::Crs;

/// `crs`, or [`Crs::Unknown`] with a notice if it is too long for the header of a stream.
pub(crate) fn fitting(crs: Crs, notices: &mut Vec<String>) -> Crs {
    let len = match &crs {
        Crs::Unknown => 0,
        Crs::Wkt(text) => text.len(),
        Crs::GeoKeys { directory, doubles, ascii } => directory.len() + doubles.len() + ascii.len(),
    };
    if len <= CRS_LEN_MAX {
        return crs;
    }
    notices.push(format!(
        "the coordinate reference system is {len} bytes long, a stream can hold {CRS_LEN_MAX}: leaving it out"
    ));
    Crs::Unknown
}

/// The system of a LAS file: that of the well-known text if the header promises text, else that of the GeoTIFF
/// keys; the other one if that is missing or defines no system of x and y.
pub(crate) fn of_records(
    wkt: Option<Vec<u8>>,
    keys: [Option<Vec<u8>>; 3],
    promises_wkt: bool,
    notices: &mut Vec<String>,
) -> Crs {
    let wkt = wkt.map_or(Crs::Unknown, |bytes| {
        let text = String::from_utf8_lossy(&bytes);
        let text = text.trim_end_matches('\0');
        if text.trim().is_empty() { Crs::Unknown } else { Crs::Wkt(text.to_string()) }
    });
    let [directory, doubles, ascii] = keys.map(Option::unwrap_or_default);
    // A directory no longer than its own header of four numbers is empty.
    let has_keys = directory.len() > 8;
    let keys = if has_keys { Crs::GeoKeys { directory, doubles, ascii } } else { Crs::Unknown };
    match (promises_wkt, wkt, keys) {
        (true, Crs::Unknown, keys @ Crs::GeoKeys { .. }) => {
            notices.push("the header promises a CRS as text, found GeoTIFF keys only".to_string());
            keys
        }
        (_, Crs::Unknown, only) | (_, only, Crs::Unknown) => only,
        (true, wkt, keys) => preferred([("text", wkt), ("GeoTIFF keys", keys)], notices),
        (false, wkt, keys) => preferred([("GeoTIFF keys", keys), ("text", wkt)], notices),
    }
}

/// The first of two systems of a file, unless only the second one says what x and y are.
fn preferred([(first, crs), (second, other)]: [(&str, Crs); 2], notices: &mut Vec<String>) -> Crs {
    let (of_first, of_second) = (System::of(&crs), System::of(&other));
    if of_first.horizontal.is_none() && of_second.horizontal.is_some() {
        notices.push(format!("the CRS in its {first} says nothing of x and y: taking that of its {second}"));
        return other;
    }
    let found = differences(&of_first, &of_second).join("; ");
    if !found.is_empty() {
        let what = format!("the CRS in its {first} and that in its {second} differ ({found})");
        notices.push(format!("{what}: taking that in its {first}"));
    }
    crs
}

/// The system that all `files`, given as (name, system), share: the first that states most. A file that
/// states none, or none of heights, takes that of the others.
pub(crate) fn common<'s>(
    files: impl Iterator<Item = (&'s str, &'s Crs)>,
    notices: &mut Vec<String>,
) -> Result<Crs> {
    let mut found: Option<Member> = None;
    let (mut silent, mut without_heights): (Option<Member>, Option<&str>) = (None, None);
    for (name, crs) in files {
        if found.as_ref().is_some_and(|first| first.crs == crs) {
            continue;
        }
        let member = Member { name, crs, system: System::of(crs) };
        if !member.is_stated() {
            if let Some(first) = &silent {
                first.check_heights(&member)?;
            }
            silent = silent.filter(|first| first.heights() >= member.heights()).or(Some(member));
            continue;
        }
        let Some(first) = &found else {
            found = Some(member);
            continue;
        };
        first.check(&member)?;
        let (of_first, of_member) = (first.heights(), member.heights());
        if of_first != of_member {
            let without = if of_first < of_member { first } else { &member };
            without_heights = without_heights.or(Some(without.name));
        }
        if first.rank() < member.rank() {
            found = Some(member);
        }
    }
    let Some(member) = found.as_ref().or(silent.as_ref()) else { return Ok(Crs::Unknown) };
    if let (Some(first), Some(silent)) = (&found, &silent) {
        first.check_heights(silent)?;
        notices.push(taken(silent.name, "", first.name));
    }
    notices.extend(without_heights.map(|without| taken(without, " for heights", member.name)));
    let remark = |remark: &String| format!("{}: coordinate reference system: {remark}", member.name);
    notices.extend(member.system.remarks.iter().map(remark));
    Ok(member.crs.clone())
}

fn taken(name: &str, what: &str, from: &str) -> String {
    format!("{name}: states no coordinate reference system{what}, taking that of {from}")
}

/// A file with its system.
#[derive(Debug, Clone)]
struct Member<'s> {
    name: &'s str,
    crs: &'s Crs,
    system: System,
}

impl Member<'_> {
    /// Whether it is a system: some files have keys that define nothing but units.
    fn is_stated(&self) -> bool {
        match self.crs {
            Crs::Unknown => false,
            Crs::Wkt(_) => true,
            Crs::GeoKeys { .. } => self.system.horizontal.is_some(),
        }
    }

    /// How much it says of heights: nothing, their unit, or what they are.
    fn heights(&self) -> u8 {
        self.system.vertical.as_ref().map_or(0, |vertical| if vertical.is_only_unit() { 1 } else { 2 })
    }

    /// How much it says: of heights, and whether x and y have a code. So the order of files does not matter.
    fn rank(&self) -> (u8, bool) {
        let has_code = self.system.horizontal.as_ref().is_some_and(|horizontal| horizontal.code.is_some());
        (self.heights(), has_code)
    }

    fn check(&self, other: &Member) -> Result<()> {
        let is_known = self.system.horizontal.is_some() && other.system.horizontal.is_some();
        let found = differences(&self.system, &other.system);
        if self.crs == other.crs || is_known && found.is_empty() {
            Ok(())
        } else {
            self.refuse(other, &found)
        }
    }

    /// The same, where one of them does not say what x and y are.
    fn check_heights(&self, other: &Member) -> Result<()> {
        let found = differences(&self.system, &other.system);
        if found.is_empty() { Ok(()) } else { self.refuse(other, &found) }
    }

    fn refuse(&self, other: &Member, found: &[String]) -> Result<()> {
        let name = |member: &Member| member.system.name().unwrap_or_else(|| "unnamed".to_string());
        let what = if found.is_empty() { String::new() } else { format!(" ({})", found.join("; ")) };
        Err(Error::usage(format!(
            "the coordinate reference systems differ: {} in {}, {} in {}{what}: transform one of them, or state the \
             system of all with spfinalize --crs",
            name(self),
            self.name,
            name(other),
            other.name
        )))
    }
}
