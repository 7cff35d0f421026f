//! Many files as one input that can be read several times.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::crs::{self, common_crs};
use super::detect::{self, detect};
use super::grid::{self, Member};
use super::las_header::LasHeader;
use super::origin::{Origin, name_of};
use super::placement::Placement;
use super::point_arrays::{self, ArrayPass, PointArray};
use super::raw_type::RawType;
use super::records::RecordPass;
use super::text::Columns;
use super::{Description, PointReader, SourceOptions, raw, spa, spb, stream, text, vtk};
use spmesh_core::error::{Error, Result};
use spmesh_model::bounds::{Bounds, Point};
use spmesh_stream::{Coordinates, Crs};

/// One pass over the points of one file.
pub(super) trait Pass: Send {
    /// Puts the next points into `batch`, about `BATCH_POINTS` of them; none may be left after filters.
    /// Returns false at the end of the file, with nothing put.
    fn next_batch(&mut self, placement: &mut Placement, batch: &mut Vec<Point>) -> Result<bool>;
}

/// What a file says of itself.
#[derive(Debug)]
pub(super) struct Stated {
    pub(super) coordinates: Coordinates,
    /// Whether points have a third coordinate; `None` if the file has no points to tell.
    pub(super) has_z: Option<bool>,
    pub(super) crs: Crs,
    /// Bounding box, in stored coordinates.
    pub(super) bounds: Option<Bounds>,
    pub(super) points: Option<u64>,
}

/// One file of an input.
#[derive(Debug)]
pub(super) struct Source {
    pub(super) name: String,
    pub(super) stated: Stated,
    origin: Origin,
    content: Content,
}

/// What a file is, with what of its header a pass needs.
#[derive(Debug)]
enum Content {
    Las(Box<LasHeader>),
    Stream,
    Twin,
    Spa,
    Spb,
    Ply,
    Obj,
    /// VTK, and raw numbers.
    Arrays(Arc<[PointArray]>),
    Text(Columns),
}

/// Files of any format as one input, in one coordinate encoding, which can be read several times.
#[derive(Debug)]
pub struct Input {
    sources: Arc<[Source]>,
    options: SourceOptions,
    description: Description,
    notices: Vec<String>,
}

impl Input {
    /// Opens `paths` ("-" is standard input), recognises each file by its content, reads its header, and finds
    /// the encoding that all points share.
    ///
    /// Cost: the headers; what cannot be read twice is copied to an unlinked temporary file.
    ///
    /// # Errors
    /// If a file cannot be opened or its header is damaged (the file is named), or the files or options do
    /// not go together ([`spmesh_core::error::ErrorKind::Usage`]).
    pub fn open(paths: &[PathBuf], options: &SourceOptions) -> Result<Input> {
        check_options(paths, options)?;
        let mut notices = Vec::new();
        let mut sources = Vec::with_capacity(paths.len());
        for path in paths {
            sources.push(Source::open(path, options, &mut notices)?);
        }
        Input::of_sources(sources, options, notices)
    }

    /// As `open`, from one file that is open already; `name` is what messages call it.
    pub(super) fn open_file(file: File, name: &str, options: &SourceOptions) -> Result<Input> {
        Input::of_origin(Origin::Open(Arc::new(file)), name.to_string(), options)
    }

    /// As `open`, from the bytes of one file; `name` is what messages call it.
    pub(super) fn of_origin(origin: Origin, name: String, options: &SourceOptions) -> Result<Input> {
        check_options(&[PathBuf::from(&name)], options)?;
        let mut notices = Vec::new();
        let source = Source::new(origin, name, options, &mut notices)?;
        Input::of_sources(vec![source], options, notices)
    }

    fn of_sources(sources: Vec<Source>, options: &SourceOptions, mut notices: Vec<String>) -> Result<Input> {
        let description = describe(&sources, options, &mut notices)?;
        Ok(Input { sources: sources.into(), options: options.clone(), description, notices })
    }

    /// What is known before the points are read.
    #[must_use]
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// What the user should know: spools, and what was odd in the files.
    #[must_use]
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// Whether decoding a file costs more than writing its points to disk and reading them back: compressed files
    /// and text.
    #[must_use]
    pub fn is_costly(&self) -> bool {
        self.sources.iter().any(|source| match &source.content {
            Content::Las(header) => header.laz.is_some(),
            Content::Twin | Content::Spa | Content::Ply | Content::Obj | Content::Text(_) => true,
            Content::Arrays(arrays) => point_arrays::are_costly(arrays),
            Content::Stream | Content::Spb => false,
        })
    }

    /// What messages about all files call them: the first one, and the number of the others.
    #[must_use]
    pub fn name(&self) -> String {
        let first = &self.sources[0].name;
        match self.sources.len() - 1 {
            0 => first.clone(),
            others => format!("{first} and {others} more"),
        }
    }

    /// Starts a pass over all points, file by file in the given order.
    ///
    /// Memory: one batch, and for compressed files one group of chunks.
    ///
    /// # Errors
    /// If the first file cannot be opened.
    pub fn read(&self) -> Result<Box<dyn PointReader>> {
        let mut reader = InputReader {
            sources: Arc::clone(&self.sources),
            options: self.options.clone(),
            coordinates: self.description.coordinates,
            next: 0,
            current: None,
            invalid: 0,
        };
        reader.open_next()?;
        Ok(Box::new(reader))
    }
}

impl Source {
    fn open(path: &Path, options: &SourceOptions, notices: &mut Vec<String>) -> Result<Source> {
        let temp_dir = options.temp_dir.clone().unwrap_or_else(std::env::temp_dir);
        let origin = Origin::new(path, &temp_dir, notices)?;
        let name = name_of(path);
        Source::new(origin, name, options, notices)
    }

    fn new(
        origin: Origin,
        name: String,
        options: &SourceOptions,
        notices: &mut Vec<String>,
    ) -> Result<Source> {
        let mut own_notices = Vec::new();
        let (content, mut stated) =
            Content::read(&origin, &name, options.raw, &mut own_notices).map_err(|e| e.of_input(&name))?;
        stated.crs = crs::fitting(stated.crs, &mut own_notices);
        notices.extend(own_notices.into_iter().map(|notice| format!("{name}: {notice}")));
        let source = Source { name, origin, content, stated };
        source.check(options).map_err(|e| e.of_input(&source.name))?;
        Ok(source)
    }

    /// Refuses what the file cannot give.
    fn check(&self, options: &SourceOptions) -> Result<()> {
        if !matches!(self.content, Content::Las(_)) {
            if !options.keep_class.is_empty() || !options.drop_class.is_empty() {
                return Err(Error::usage("classes are unknown here: only LAS and LAZ files have them"));
            }
            if options.first_only || options.last_only {
                return Err(Error::usage("returns are unknown here: only LAS and LAZ files have them"));
            }
        }
        if options.dims == 3 && self.stated.has_z == Some(false) {
            return Err(Error::usage(
                "points have no third coordinate, three dimensions need it: for a triangulation in the plane use \
                 spfinalize | spdelaunay2d",
            ));
        }
        Ok(())
    }

    fn pass(&self, options: &SourceOptions) -> Result<Box<dyn Pass>> {
        let view = self.origin.view()?;
        Ok(match &self.content {
            Content::Las(header) => Box::new(RecordPass::new(view, header, options)?),
            Content::Stream => Box::new(stream::pass(view, &self.name)?),
            Content::Twin => Box::new(stream::pass_of_twin(view, &self.name)?),
            Content::Spa => Box::new(spa::pass(view)?),
            Content::Spb => Box::new(spb::pass(view)?),
            Content::Ply => Box::new(stream::pass_of_ply(view, &self.name)?),
            Content::Obj => Box::new(stream::pass_of_obj(view, &self.name)),
            Content::Arrays(arrays) => Box::new(ArrayPass::new(view, Arc::clone(arrays))),
            Content::Text(columns) => Box::new(text::TextPass::new(view, columns.clone())),
        })
    }
}

impl Content {
    fn read(
        origin: &Origin,
        name: &str,
        raw: Option<RawType>,
        notices: &mut Vec<String>,
    ) -> Result<(Content, Stated)> {
        let view = origin.view()?;
        if let Some(kind) = raw {
            return Ok(Content::of_arrays(vec![raw::open(&view, name, kind)?]));
        }
        Ok(match detect(&view)? {
            detect::Format::Las => {
                let header = LasHeader::read(&view, notices)?;
                let stated = Stated {
                    coordinates: header.coordinates,
                    has_z: Some(true),
                    crs: header.crs.clone(),
                    bounds: header.bounds,
                    points: Some(header.points),
                };
                (Content::Las(Box::new(header)), stated)
            }
            detect::Format::Stream => (Content::Stream, stream::state(view, name)?),
            detect::Format::Twin => (Content::Twin, stream::state_of_twin(view, name)?),
            detect::Format::Spa => (Content::Spa, spa::state(view)?),
            detect::Format::Spb => (Content::Spb, spb::state(view)?),
            detect::Format::Ply => (Content::Ply, stream::state_of_ply(view, name)?),
            detect::Format::Obj => (Content::Obj, stream::state_of_obj(view, name)?),
            detect::Format::VtkLegacy => Content::of_arrays(vec![vtk::read_legacy(&view, name)?]),
            detect::Format::VtkXml => Content::of_arrays(vtk::read_xml(&view)?),
            detect::Format::Text => {
                let (columns, stated) = text::state(view)?;
                (Content::Text(columns), stated)
            }
        })
    }

    fn of_arrays(arrays: Vec<PointArray>) -> (Content, Stated) {
        let stated = point_arrays::state(&arrays);
        (Content::Arrays(arrays.into()), stated)
    }
}

fn check_options(paths: &[PathBuf], options: &SourceOptions) -> Result<()> {
    if paths.is_empty() {
        return Err(Error::usage("no input"));
    }
    if paths.iter().filter(|path| path.as_os_str() == "-").count() > 1 {
        return Err(Error::usage("standard input (-) is given more than once"));
    }
    if !matches!(options.dims, 2 | 3) {
        return Err(Error::usage(format!("{} dimensions, expected 2 or 3", options.dims)));
    }
    if let Some(Bounds { min, max }) = options.bounds
        && !(0..3).all(|axis| min[axis] <= max[axis])
    {
        return Err(Error::usage(format!(
            "the box from {min:?} to {max:?} is empty, expected the least coordinates first"
        )));
    }
    if let Some((scale, offset)) = options.grid {
        if !scale.iter().all(|&scale| scale > 0.0 && scale.is_finite())
            || !offset.iter().all(|offset| offset.is_finite())
        {
            return Err(Error::usage(format!("scale {scale:?} with offset {offset:?} is no grid")));
        }
        let geometry = &scale[..usize::from(options.dims)];
        if geometry.iter().any(|&scale| scale != geometry[0]) {
            return Err(Error::usage(format!("the scales {geometry:?} of the geometry must be equal")));
        }
    }
    Ok(())
}

fn describe(sources: &[Source], options: &SourceOptions, notices: &mut Vec<String>) -> Result<Description> {
    let coordinates = match options.grid {
        Some((scale, offset)) => Coordinates::I32 { scale, offset },
        None => {
            let member = |source: &Source| -> Member {
                let Stated { coordinates, bounds, .. } = source.stated;
                Member { name: source.name.clone(), coordinates, bounds }
            };
            grid::common(&sources.iter().map(member).collect::<Vec<_>>(), options.dims)?
        }
    };
    Ok(Description {
        coordinates,
        dims: options.dims,
        has_elevation: has_z(sources)? && options.dims == 2,
        crs: common_crs(sources, notices)?,
        stated_bounds: stated_bounds(sources, &coordinates),
        stated_points: sources.iter().map(|source| source.stated.points).sum(),
    })
}

fn has_z(sources: &[Source]) -> Result<bool> {
    let find = |wanted| sources.iter().find(|source| source.stated.has_z == Some(wanted));
    match (find(true), find(false)) {
        (Some(with), Some(without)) => Err(Error::usage(format!(
            "points of {} have an elevation, those of {} have none",
            with.name, without.name
        ))),
        (with, _) => Ok(with.is_some()),
    }
}

/// The union of the stated boxes in `coordinates`; `None` if a file states none.
fn stated_bounds(sources: &[Source], coordinates: &Coordinates) -> Option<Bounds> {
    let mut corners = Vec::with_capacity(2 * sources.len());
    for source in sources {
        if source.stated.points == Some(0) {
            continue;
        }
        let bounds = source.stated.bounds?;
        let mut placement = Placement::new(&source.stated.coordinates, coordinates, None, false);
        placement.put(bounds.min, &mut corners).ok()?;
        placement.put(bounds.max, &mut corners).ok()?;
    }
    Bounds::of_points(&corners)
}

/// One pass over all files.
struct InputReader {
    sources: Arc<[Source]>,
    options: SourceOptions,
    coordinates: Coordinates,
    /// Number of the file after the current one.
    next: usize,
    current: Option<(Box<dyn Pass>, Placement)>,
    /// Points dropped in files before the current one.
    invalid: u64,
}

impl InputReader {
    /// Opens the next file, if there is one.
    fn open_next(&mut self) -> Result<()> {
        if let Some((_, placement)) = self.current.take() {
            self.invalid += placement.invalid;
        }
        if let Some(source) = self.sources.get(self.next) {
            let pass = source.pass(&self.options).map_err(|e| e.of_input(&source.name))?;
            let Stated { coordinates, .. } = source.stated;
            let SourceOptions { bounds, skip_invalid, .. } = self.options;
            self.current =
                Some((pass, Placement::new(&coordinates, &self.coordinates, bounds, skip_invalid)));
            self.next += 1;
        }
        Ok(())
    }
}

impl PointReader for InputReader {
    fn next_batch(&mut self, batch: &mut Vec<Point>) -> Result<()> {
        batch.clear();
        while let Some((pass, placement)) = &mut self.current {
            let source = &self.sources[self.next - 1];
            let goes_on = pass.next_batch(placement, batch).map_err(|e| e.of_input(&source.name))?;
            if !batch.is_empty() {
                return Ok(());
            }
            if !goes_on {
                self.open_next()?;
            }
        }
        Ok(())
    }

    fn invalid(&self) -> u64 {
        self.invalid + self.current.as_ref().map_or(0, |(_, placement)| placement.invalid)
    }
}
