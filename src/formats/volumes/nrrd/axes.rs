//! The axes of an NRRD volume: sizes, coordinates along them, and world coordinates of the samples.

use crate::text::lines::quote;
use crate::volumes::lattice::{Frame, Lattice};
use crate::volumes::nrrd::fields::{Fields, integer};
use crate::volumes::world::World;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;

/// The sites of the volume.
pub(crate) fn lattice(fields: &Fields, warnings: &mut Vec<String>) -> Result<Lattice> {
    let dimension = fields.parse("dimension", |text| match integer(text, "3 or 4")? {
        dimension @ (3 | 4) => Ok(dimension as usize),
        other => Err(Error::malformed(format!("found {other} dimensions, expected 3 or 4"))),
    })?;
    let sizes = fields.parse("sizes", |text| {
        let sizes: Vec<u64> =
            text.split_whitespace().map(|size| integer(size, "a size")).collect::<Result<_>>()?;
        match sizes.len() {
            len if len == dimension => Ok(sizes),
            len => Err(Error::malformed(format!("found {len} sizes for {dimension} dimensions"))),
        }
    })?;
    let mut lens = [1; 4];
    lens[..dimension].copy_from_slice(&sizes);
    let coordinates = coordinates(fields, dimension)?;
    if dimension == 3 {
        let fixed = ['x', 'y', 'z', 't'][coordinates[3]];
        warnings.push(format!("the volume has three dimensions: all points have {fixed} = 0"));
    }
    let located = |e: Error| fields.locate("sizes", Error::malformed(e.to_string()));
    Lattice::along(lens, coordinates).map_err(located)
}

/// The coordinate (x, y, z or t) along each axis, by `kinds`.
fn coordinates(fields: &Fields, dimension: usize) -> Result<[usize; 4]> {
    let kinds: Vec<String> =
        fields.get("kinds").unwrap_or("").split_whitespace().map(str::to_ascii_lowercase).collect();
    let malformed = |message: String| fields.locate("kinds", Error::malformed(message));
    if !kinds.is_empty() && kinds.len() != dimension {
        return Err(malformed(format!("found {} kinds for {dimension} dimensions", kinds.len())));
    }
    let of_components =
        |kind: &&String| !matches!(kind.as_str(), "domain" | "space" | "time" | "list" | "none" | "???");
    if let Some(kind) = kinds.iter().find(of_components) {
        let message =
            format!("an axis is of kind {kind}: values must be single numbers; take one component first");
        return Err(malformed(message));
    }
    let of_kind =
        |wanted: &str| -> Vec<usize> { (0..kinds.len()).filter(|&axis| kinds[axis] == wanted).collect() };
    let time = match (&of_kind("time")[..], &of_kind("list")[..]) {
        ([_, _, ..], _) => return Err(malformed("several axes are of kind time".to_string())),
        ([axis], _) | ([], [axis]) => *axis,
        // In a volume of three dimensions this is the added axis of size 1.
        _ => 3,
    };
    let mut space = 0..3;
    Ok([0, 1, 2, 3].map(|axis| if axis == time { 3 } else { space.next().unwrap_or(3) }))
}

/// World coordinates of samples, or why they are not known: by `space directions` and `space origin`; along
/// axes without a direction, such as time, by `spacings`, `axis mins` and `axis maxs`. Axes without such data
/// keep their indices.
pub(crate) fn world(fields: &Fields) -> std::result::Result<World, String> {
    let text = |e: Error| e.to_string();
    let coordinates = dimension(fields).and_then(|dimension| coordinates(fields, dimension)).map_err(text)?;
    let scalar = by_spacings(fields)?;
    if let Some((origin, steps)) = in_space(fields, &coordinates)? {
        let time = coordinates.iter().position(|&coordinate| coordinate == 3);
        let along = time.zip(scalar).and_then(|(axis, scalar)| scalar.get(axis).copied());
        return World::new(origin, steps, None, along.unwrap_or(INDICES));
    }
    let axes = by_directions(fields, scalar.as_deref())?.or(scalar);
    let Some(axes) = axes else { return Err("the header states no spacing".to_string()) };
    let mut frame = Frame::default();
    for ([min, step], coordinate) in axes.into_iter().zip(coordinates) {
        if !min.is_finite() || !step.is_finite() || step == 0.0 {
            return Err(format!("samples of an axis cannot start at {min} and be {step} apart"));
        }
        (frame.mins[coordinate], frame.steps[coordinate]) = (min, step);
    }
    Ok(World { coordinates: [0, 1, 2], frame, orientation: None })
}

/// The origin and the directions of the three axes in space, if these and no others have directions, and
/// space has three dimensions.
fn in_space(
    fields: &Fields,
    coordinates: &[usize; 4],
) -> std::result::Result<Option<(Point, [Point; 3])>, String> {
    let Some(directions) = fields.get("space directions") else { return Ok(None) };
    let origin = match fields.get("space origin") {
        Some(origin) => vectors(origin)?.into_iter().flatten().next().unwrap_or_default(),
        None => vec![0.0; 3],
    };
    let (Ok(origin), directions) = (Point::try_from(origin), vectors(directions)?) else { return Ok(None) };
    if directions.len() != dimension(fields).map_err(|e| e.to_string())? {
        return Ok(None);
    }
    let mut steps = Vec::new();
    for (direction, &coordinate) in directions.into_iter().zip(coordinates) {
        match direction.map(Point::try_from) {
            Some(Ok(step)) if coordinate < 3 => steps.push(step),
            None if coordinate == 3 => {}
            _ => return Ok(None),
        }
    }
    Ok(steps.try_into().ok().map(|steps| (origin, steps)))
}

fn dimension(fields: &Fields) -> Result<usize> {
    fields.parse("dimension", |text| Ok(integer(text, "3 or 4")? as usize))
}

/// First sample and step of each axis.
type Axes = Option<Vec<[f64; 2]>>;

/// Those of an axis that keeps its indices.
const INDICES: [f64; 2] = [0.0, 1.0];

/// By vectors: each may have a component along its own axis only. `none` marks axes that are not spatial,
/// which `scalar` tells of.
fn by_directions(fields: &Fields, scalar: Option<&[[f64; 2]]>) -> std::result::Result<Axes, String> {
    let Some(directions) = fields.get("space directions") else { return Ok(None) };
    let directions = vectors(directions)?;
    if directions.len() != dimension(fields).map_err(|e| e.to_string())? {
        return Err("there is not one of the space directions for each axis".to_string());
    }
    let rank = directions.iter().flatten().map(Vec::len).max().unwrap_or(0);
    let origin = match fields.get("space origin") {
        Some(origin) => vectors(origin)?.into_iter().flatten().next().unwrap_or_default(),
        None => vec![0.0; rank],
    };
    if origin.len() != rank || directions.iter().flatten().any(|direction| direction.len() != rank) {
        return Err("space origin and space directions have different numbers of components".to_string());
    }
    let mut axes = Vec::new();
    let mut next = 0;
    for (axis, direction) in directions.iter().enumerate() {
        let Some(direction) = direction else {
            axes.push(scalar.map_or(INDICES, |scalar| scalar[axis]));
            continue;
        };
        if next == rank || direction.iter().enumerate().any(|(at, &part)| at != next && part != 0.0) {
            return Err("the grid does not lie along the axes of the world".to_string());
        }
        axes.push([origin[next], direction[next]]);
        next += 1;
    }
    Ok(Some(axes))
}

/// By distances: `nan` marks axes without data.
fn by_spacings(fields: &Fields) -> std::result::Result<Axes, String> {
    let dimension = dimension(fields).map_err(|e| e.to_string())?;
    let column = |name: &str| -> std::result::Result<Vec<Option<f64>>, String> {
        let Some(text) = fields.get(name) else { return Ok(vec![None; dimension]) };
        let found: Vec<_> = text.split_whitespace().map(number).collect::<std::result::Result<_, _>>()?;
        let known = |value: f64| (!value.is_nan()).then_some(value);
        if found.len() != dimension {
            return Err(format!("{name} has {} entries for {dimension} dimensions", found.len()));
        }
        Ok(found.into_iter().map(known).collect())
    };
    let [spacings, mins, maxs] = [column("spacings")?, column("axis mins")?, column("axis maxs")?];
    if [&spacings, &mins, &maxs].iter().all(|column| column.iter().all(Option::is_none)) {
        return Ok(None);
    }
    let sizes = fields.get("sizes").unwrap_or("").split_whitespace().map(number);
    let centers =
        fields.get("centers").unwrap_or("").split_whitespace().map(Some).chain(std::iter::repeat(None));
    let mut axes = Vec::new();
    for (axis, (size, center)) in sizes.zip(centers).enumerate() {
        let is_cell = center.is_some_and(|center| center.eq_ignore_ascii_case("cell"));
        // Between the outer borders of cells there is one step more than between their centers.
        let steps = if is_cell { size? } else { size? - 1.0 };
        let between =
            mins[axis].zip(maxs[axis]).filter(|_| steps > 0.0).map(|(min, max)| (max - min) / steps);
        let step = spacings[axis].or(between).unwrap_or(1.0);
        let min = mins[axis].map_or(0.0, |min| if is_cell { min + step / 2.0 } else { min });
        axes.push([min, step]);
    }
    Ok(Some(axes))
}

/// The units that the header states: of lengths, and of times.
pub(crate) fn units(fields: &Fields) -> Result<[Vec<String>; 2]> {
    let coordinates = coordinates(fields, dimension(fields)?)?;
    let quoted = |name: &str| -> Vec<String> {
        let units = fields.get(name).unwrap_or("").split('"').skip(1).step_by(2);
        units.map(|unit| unit.trim().to_string()).collect()
    };
    let (mut lengths, mut times) = (quoted("space units"), Vec::new());
    let has_space = !lengths.is_empty();
    for (unit, coordinate) in quoted("units").into_iter().zip(coordinates) {
        match coordinate {
            3 => times.push(unit),
            _ if has_space => {}
            _ => lengths.push(unit),
        }
    }
    Ok([lengths, times]
        .map(|units| units.into_iter().filter(|unit| !unit.is_empty() && unit != "???").collect()))
}

/// Parses vectors such as `(1,0,0) none (0, 2, 0)`.
fn vectors(text: &str) -> std::result::Result<Vec<Option<Vec<f64>>>, String> {
    let mut vectors = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        rest = if let Some(after) = rest.strip_prefix("none") {
            vectors.push(None);
            after
        } else {
            let inner = rest.strip_prefix('(').and_then(|rest| rest.split_once(')'));
            let (inner, after) = inner
                .ok_or_else(|| format!("found {}, expected a vector like (1,0,0)", quote(rest.as_bytes())))?;
            vectors.push(Some(inner.split(',').map(number).collect::<std::result::Result<_, _>>()?));
            after
        }
        .trim_start();
    }
    Ok(vectors)
}

fn number(text: &str) -> std::result::Result<f64, String> {
    text.trim().parse().map_err(|_| format!("found {}, expected a number", quote(text.as_bytes())))
}
