//! Many files as one input that can be read several times.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use crate::detect::{Format, read_head};
use crate::historical::{read_spa, read_spb};
use crate::las::header::LasHeader;
use crate::las::index;
use crate::molecules::atoms::{self, AtomPass, Atoms};
use crate::npy::read::{NpyArray, NpyPass};
use crate::raw::read as raw;
use crate::source::crs;
use crate::source::cut::Cut;
use crate::source::describe::{File, describe};
use crate::source::filters::{DropReason, Dropped};
use crate::source::input_reader::{InputReader, Passed};
use crate::source::options::SourceOptions;
use crate::source::origin::{Origin, name_of};
use crate::source::pass::{Pass, Stated};
use crate::source::point_arrays::{self, ArrayPass, PointArray};
use crate::source::reader::{Description, PointReader};
use crate::source::records::RecordPass;
use crate::source::row_plan::RowPlan;
use crate::source::stream;
use crate::text::columns::{self, Columns};
use crate::text::read::TextPass;
use crate::vtk;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Bounds;

/// One file of an input.
#[derive(Debug)]
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) stated: Stated,
    origin: Origin,
    is_compressed: bool,
    content: Content,
    /// What is left of the file, if it was cut off; of a text, that is known after a pass.
    pub(crate) cut: OnceLock<Cut>,
}

/// The format of a file, with the parts of its header that a pass needs.
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
    Npy(NpyArray),
    /// Molecular structures, which are read when they are opened.
    Atoms(Atoms),
    Text(Columns),
}

/// Files of any format as one input, in one coordinate encoding, which can be read several times.
#[derive(Debug)]
pub struct Input {
    sources: Arc<[Source]>,
    options: SourceOptions,
    description: Description,
    /// How the rows of each file are made.
    plans: Arc<[RowPlan]>,
    notices: Vec<String>,
    /// What the first whole pass has seen.
    passed: Arc<OnceLock<Passed>>,
}

impl Input {
    /// Opens `paths` ("-" is standard input), recognizes each file by its content, reads its header, and
    /// finds the encoding that all points share.
    ///
    /// Cost: the headers, and with a reach the indices. Inputs that cannot be read twice, and compressed files of formats that are not read
    /// sequentially, are copied to unlinked temporary files.
    ///
    /// # Errors
    /// If a file cannot be opened or its header is damaged (the file is named), or the files or options are
    /// incompatible ([`spmesh_base::error::ErrorKind::Usage`]).
    pub fn open(paths: &[PathBuf], options: &SourceOptions) -> Result<Input> {
        check_options(paths, options)?;
        let mut notices = Vec::new();
        let mut sources = Vec::with_capacity(paths.len());
        for path in paths {
            sources.push(Source::open(path, options, &mut notices)?);
        }
        Input::of_sources(sources, options, notices)
    }

    /// As `open`, from the bytes of `input`, which are copied to an unlinked temporary file. Messages call
    /// the input `name`.
    ///
    /// # Errors
    /// As [`Input::open`], and if `input` cannot be read.
    pub fn copied(input: impl Read, name: &str, options: &SourceOptions) -> Result<Input> {
        let origin = Origin::spooled(input, &options.temp_dir()).map_err(|e| e.of_input(name))?;
        Input::of_origin(origin, name.to_string(), options)
    }

    /// As `open`, from the bytes of one file. Messages call it `name`.
    pub(crate) fn of_origin(origin: Origin, name: String, options: &SourceOptions) -> Result<Input> {
        check_options(&[PathBuf::from(&name)], options)?;
        let mut notices = Vec::new();
        let source = Source::new(origin, name, options, &mut notices)?;
        Input::of_sources(vec![source], options, notices)
    }

    fn of_sources(sources: Vec<Source>, options: &SourceOptions, mut notices: Vec<String>) -> Result<Input> {
        let files: Vec<File> =
            sources.iter().map(|Source { name, stated, .. }| File { name, stated }).collect();
        let (description, plans) = describe(&files, options, &mut notices)?;
        let (sources, plans) = (sources.into(), plans.into());
        Ok(Input { sources, options: options.clone(), description, plans, notices, passed: Arc::default() })
    }

    /// What is known before the points are read.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Notices for the user: spools, and oddities in the files.
    pub fn notices(&self) -> &[String] {
        &self.notices
    }

    /// How many points the filters dropped; none before the end of the first pass.
    pub fn dropped(&self) -> Dropped {
        self.passed.get().map_or_else(Dropped::default, |passed| passed.dropped)
    }

    /// After a pass: the points of each file in the window of the options, with those that were dropped.
    pub fn counts(&self) -> &[u64] {
        self.passed.get().map_or(&[], |passed| &passed.counts)
    }

    /// After a pass: for each file that was cut off, what is left of it.
    pub fn salvaged(&self) -> Vec<String> {
        self.sources.iter().filter_map(|source| Some(source.cut.get()?.describe(&source.name))).collect()
    }

    /// After a pass: a notice if withheld points were dropped.
    pub fn withheld_notice(&self) -> Option<String> {
        let count = self.dropped().of(DropReason::Withheld);
        let points = if count == 1 { "point" } else { "points" };
        (count > 0).then(|| {
            format!(
                "{}: {count} withheld {points} dropped (spfinalize --keep-withheld keeps them)",
                self.name()
            )
        })
    }

    /// After a pass: a notice if points with a coordinate that is not finite were dropped.
    pub fn invalid_notice(&self) -> Option<String> {
        let count = self.passed.get().map_or(0, |passed| passed.invalid);
        let points = if count == 1 { "point" } else { "points" };
        let what = format!("{}: {count} {points} with a coordinate that is not finite dropped", self.name());
        (count > 0).then_some(what)
    }

    /// Whether decoding a file costs more than writing its points to disk and reading them back: compressed
    /// files and text.
    pub fn is_costly(&self) -> bool {
        self.sources.iter().any(|source| {
            source.is_compressed
                || match &source.content {
                    Content::Las(header) => header.laz.is_some(),
                    Content::Twin | Content::Spa | Content::Ply | Content::Obj | Content::Text(_) => true,
                    Content::Arrays(arrays) => point_arrays::are_costly(arrays),
                    Content::Stream | Content::Spb | Content::Npy(_) | Content::Atoms(_) => false,
                }
        })
    }

    /// Name of the whole input in messages: the first file, and the number of other files.
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
        let (sources, plans) = (Arc::clone(&self.sources), Arc::clone(&self.plans));
        let coordinates = self.description.coordinates;
        let passed = Arc::clone(&self.passed);
        let reader = InputReader::new(sources, plans, self.options.clone(), coordinates, passed)?;
        Ok(Box::new(reader))
    }
}

impl Source {
    fn open(path: &Path, options: &SourceOptions, notices: &mut Vec<String>) -> Result<Source> {
        let origin = Origin::new(path, options.admitted(), &options.temp_dir(), notices)?;
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
        let origin = origin.of_use(options.purpose());
        let found = find_format(origin, &name, options, notices).map_err(|e| e.of_input(&name))?;
        let Found { origin, format, is_compressed } = found;
        let read = match format {
            Some(format) => {
                Content::read(&origin, &name, format, options, &mut own_notices).map(|read| (read, None))
            }
            None => Content::read_raw(&origin, options),
        };
        let ((content, mut stated), mut cut) = read.map_err(|e| e.of_input(&name))?;
        if let Content::Las(header) = &content
            && header.lost > 0
        {
            cut = Some(Cut { read: header.points, lost: Some(header.lost) });
        }
        stated.crs = Arc::new(crs::fitting(Arc::unwrap_or_clone(stated.crs), &mut own_notices));
        notices.extend(own_notices.into_iter().map(|notice| format!("{name}: {notice}")));
        // Atoms are decompressed once.
        let is_compressed = is_compressed && !matches!(content, Content::Atoms(_));
        let cut = cut.map_or_else(OnceLock::new, OnceLock::from);
        let source = Source { name, origin, is_compressed, content, stated, cut };
        source.check(options).map_err(|e| e.of_input(&source.name))?;
        Ok(source)
    }

    /// Rejects options that the file's format cannot serve.
    fn check(&self, options: &SourceOptions) -> Result<()> {
        if !matches!(self.content, Content::Las(_))
            && let Some(what) = options.filters.needs()
        {
            return Err(Error::usage(format!("{what} unknown here: only LAS and LAZ files state them")));
        }
        if options.radii.is_some() && !matches!(self.content, Content::Atoms(_)) {
            return Err(Error::usage(
                "tables of radii are for atoms of PDB, mmCIF and XYZ: for other points, name an attribute",
            ));
        }
        if let Content::Las(header) = &self.content
            && matches!(header.format, 0 | 2)
            && options.filters.gps_time.is_some()
        {
            return Err(Error::usage(format!("points of format {} have no GPS time", header.format)));
        }
        if options.filters.z.is_some() && self.stated.has_z == Some(false) {
            return Err(Error::usage("points have no third coordinate, the filter of z needs it"));
        }
        if options.dims == 3 && self.stated.has_z == Some(false) {
            return Err(Error::usage(
                "points have no third coordinate, three dimensions need it: for a triangulation in the plane \
                 use \
                 spfinalize | spdelaunay2d",
            ));
        }
        Ok(())
    }

    /// Starts a pass, with the rows of `plan`.
    pub(crate) fn pass(&self, options: &SourceOptions, plan: RowPlan) -> Result<Box<dyn Pass>> {
        let origin = &self.origin;
        Ok(match &self.content {
            Content::Las(header) => Box::new(RecordPass::new(origin.view()?, header, options, plan)?),
            Content::Stream => Box::new(stream::pass(origin.plain()?, &self.name, plan)?),
            Content::Twin => Box::new(stream::pass_of_twin(origin.plain()?, &self.name, plan)?),
            Content::Spa => Box::new(read_spa::pass(origin.plain()?)?),
            Content::Spb => Box::new(read_spb::pass(origin.plain()?)?),
            Content::Ply => Box::new(stream::pass_of_ply(origin.plain()?, &self.name, plan)?),
            Content::Obj => Box::new(stream::pass_of_obj(origin.plain()?, &self.name)),
            Content::Arrays(arrays) => Box::new(ArrayPass::new(origin.view()?, Arc::clone(arrays), plan)),
            Content::Atoms(atoms) => Box::new(AtomPass::new(atoms, plan)),
            Content::Npy(array) => Box::new(NpyPass::new(&origin.view()?, array.clone())),
            Content::Text(columns) => {
                let (file, columns) = (origin.plain()?, columns.clone());
                Box::new(TextPass::new(file, columns, plan, options.salvage))
            }
        })
    }
}

/// The format of a file, and where its bytes are.
struct Found {
    origin: Origin,
    /// `None` for raw numbers.
    format: Option<Format>,
    is_compressed: bool,
}

/// Recognizes a file. A compressed file whose format is not read sequentially is decompressed to a temporary
/// file.
fn find_format(
    origin: Origin,
    name: &str,
    options: &SourceOptions,
    notices: &mut Vec<String>,
) -> Result<Found> {
    let unpacked = |origin: Origin, notices| origin.unpacked(name, &options.temp_dir(), notices);
    if options.raw.is_some() {
        let is_compressed = raw::is_compressed(Path::new(name));
        let origin = if is_compressed { unpacked(origin, notices)? } else { origin };
        return Ok(Found { origin, format: None, is_compressed });
    }
    let mut plain = origin.plain()?;
    let head = read_head(&mut plain).map_err(|e| Error::io("reading", e))?;
    let format = options.reader.detect(&head)?;
    let is_compressed = plain.is_compressed();
    let is_read_in_order = !matches!(format, Format::Las | Format::Npy | Format::VtkLegacy | Format::VtkXml);
    let origin = if is_compressed && !is_read_in_order { unpacked(origin, notices)? } else { origin };
    Ok(Found { origin, format: Some(format), is_compressed })
}

impl Content {
    fn read(
        origin: &Origin,
        name: &str,
        format: Format,
        options: &SourceOptions,
        notices: &mut Vec<String>,
    ) -> Result<(Content, Stated)> {
        let layout = &options.text;
        if layout.is_given() && !matches!(format, Format::Text | Format::OtherText) {
            let what = "options of columns, separators and comments";
            return Err(Error::usage(format!("{what} are for points as text: this is {}", format.name())));
        }
        Ok(match format {
            Format::Las => {
                let mut header = LasHeader::read(&origin.view()?, options.salvage, notices)?;
                if let Some(reach) = &options.reach {
                    header.parts = index::find_parts(origin, &header, reach, notices)?;
                }
                let stated = Stated {
                    coordinates: header.coordinates,
                    has_z: Some(true),
                    crs: Arc::new(header.crs.clone()),
                    bounds: header.bounds,
                    points: Some(header.points),
                    offers: Arc::new(header.offers.clone()),
                };
                (Content::Las(Box::new(header)), stated)
            }
            Format::Stream => (Content::Stream, stream::state(origin.plain()?, name)?),
            Format::Twin => (Content::Twin, stream::state_of_twin(origin.plain()?, name)?),
            Format::Spa => (Content::Spa, read_spa::state(origin.plain()?)?),
            Format::Spb => (Content::Spb, read_spb::state(origin.plain()?)?),
            Format::Ply => (Content::Ply, stream::state_of_ply(origin.plain()?, name)?),
            // Vertex lines of SMA are those of OBJ; its other lines are skipped.
            Format::Obj | Format::Sma | Format::VertexLines => {
                (Content::Obj, stream::state_of_obj(origin.plain()?, name)?)
            }
            Format::Npy => {
                let array = NpyArray::read(&origin.view()?)?;
                let stated = array.state();
                (Content::Npy(array), stated)
            }
            Format::VtkLegacy => Content::of_arrays(vec![vtk::read_legacy(&origin.view()?, name)?]),
            Format::VtkXml => Content::of_arrays(vtk::read_xml(&origin.view()?)?),
            Format::Text | Format::OtherText => {
                let (columns, stated) = columns::state(origin.plain()?, layout, notices)?;
                (Content::Text(columns), stated)
            }
            other => {
                let (atoms, stated) =
                    atoms::read(origin.plain()?, name, other, options.radii.as_deref(), notices)?;
                (Content::Atoms(atoms), stated)
            }
        })
    }

    /// Numbers without a header.
    fn read_raw(origin: &Origin, options: &SourceOptions) -> Result<((Content, Stated), Option<Cut>)> {
        let kind = options.raw.ok_or_else(|| Error::usage("the type of raw numbers is not given"))?;
        let (array, cut) = raw::open(&origin.view()?, kind, options.salvage)?;
        Ok((Content::of_arrays(vec![array]), cut))
    }

    fn of_arrays(arrays: Vec<PointArray>) -> (Content, Stated) {
        let stated = point_arrays::state(&arrays);
        (Content::Arrays(arrays.into()), stated)
    }
}

/// What the header of a file states.
pub(crate) fn stated_of(path: &Path, options: &SourceOptions, notices: &mut Vec<String>) -> Result<Stated> {
    Source::open(path, options, notices).map(|source| source.stated)
}

pub(crate) fn check_options(paths: &[PathBuf], options: &SourceOptions) -> Result<()> {
    if paths.is_empty() {
        return Err(Error::usage("no input"));
    }
    if paths.iter().filter(|path| path.as_os_str() == "-").count() > 1 {
        return Err(Error::usage("standard input (-) is given more than once"));
    }
    if !matches!(options.dims, 2 | 3) {
        return Err(Error::usage(format!("{} dimensions, expected 2 or 3", options.dims)));
    }
    for Bounds { min, max } in [options.bounds, options.reach].into_iter().flatten() {
        if !(0..3).all(|axis| min[axis] <= max[axis]) {
            return Err(Error::usage(format!(
                "the box from {min:?} to {max:?} is empty, expected the least coordinates first"
            )));
        }
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
