//! Many files as one input that can be read several times.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use crate::detect::{Format, read_head};
use crate::raw::read as raw;
use crate::source::crs;
use crate::source::cut::Cut;
use crate::source::describe::{File, describe};
use crate::source::filters::{DropReason, Dropped};
use crate::source::input_reader::{InputReader, Passed};
use crate::source::options::SourceOptions;
use crate::source::origin::{Origin, name_of};
use crate::source::pass::{Content, Opening, Pass, Sort, Stated};
use crate::source::reader::{Description, PointReader};
use crate::source::row_plan::RowPlan;
use crate::text::options::TextOptions;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Bounds;

/// One file of an input.
#[derive(Debug)]
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) content: Content,
    origin: Origin,
    format: Format,
    is_compressed: bool,
    /// What is left of the file, if it was cut off; of a text, that is known after a pass.
    pub(crate) cut: OnceLock<Cut>,
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
        let files: Vec<File> = sources
            .iter()
            .map(|source| File { name: &source.name, stated: &source.content.stated })
            .collect();
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
        self.sources.iter().any(|source| source.is_compressed || source.content.is_costly)
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
        let (origin, format, is_compressed) = found;
        let file = Opening { origin: &origin, name: &name, format, options };
        let content = open_points(&file, &mut own_notices).map_err(|e| e.of_input(&name))?;
        let Content { mut stated, cut, .. } = content;
        stated.crs = Arc::new(crs::fitting(Arc::unwrap_or_clone(stated.crs), &mut own_notices));
        notices.extend(own_notices.into_iter().map(|notice| format!("{name}: {notice}")));
        // Atoms are decompressed once.
        let is_compressed = is_compressed && content.sort != Sort::Atoms;
        let cut = cut.map_or_else(OnceLock::new, OnceLock::from);
        let source =
            Source { name, content: Content { stated, ..content }, origin, format, is_compressed, cut };
        source.check(options).map_err(|e| e.of_input(&source.name))?;
        Ok(source)
    }

    /// Rejects options that the file's format cannot serve.
    fn check(&self, options: &SourceOptions) -> Result<()> {
        let Content { stated, sort, .. } = &self.content;
        if !matches!(sort, Sort::Records(_))
            && let Some(what) = options.filters.needs()
        {
            return Err(Error::usage(format!("{what} unknown here: only LAS and LAZ files state them")));
        }
        if options.radii.is_some() && *sort != Sort::Atoms {
            return Err(Error::usage(
                "tables of radii are for atoms of PDB, mmCIF and XYZ: for other points, name an attribute",
            ));
        }
        if let Sort::Records(format @ (0 | 2)) = sort
            && options.filters.gps_time.is_some()
        {
            return Err(Error::usage(format!("points of format {format} have no GPS time")));
        }
        if options.filters.z.is_some() && stated.has_z == Some(false) {
            return Err(Error::usage("points have no third coordinate, the filter of z needs it"));
        }
        if options.dims == 3 && stated.has_z == Some(false) {
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
        let Source { origin, name, format, .. } = self;
        (self.content.pass)(&Opening { origin, name, format: *format, options }, plan)
    }
}

/// Recognizes a file, and says whether it is compressed. A compressed file that is not read sequentially is
/// decompressed to a temporary file.
fn find_format(
    origin: Origin,
    name: &str,
    options: &SourceOptions,
    notices: &mut Vec<String>,
) -> Result<(Origin, Format, bool)> {
    let (format, is_compressed, is_in_parts) = match options.raw {
        Some(_) => (Format::Binary, raw::is_compressed(Path::new(name)), true),
        None => {
            let mut plain = origin.plain()?;
            let head = read_head(&mut plain).map_err(|e| Error::io("reading", e))?;
            let format = options.reader.detect(&head)?;
            (format, plain.is_compressed(), format.row().is_in_parts)
        }
    };
    let origin = match is_compressed && is_in_parts {
        true => origin.unpacked(name, &options.temp_dir(), notices)?,
        false => origin,
    };
    Ok((origin, format, is_compressed))
}

/// Refuses options of text for a file of another format.
pub(crate) fn check_text_options(options: &TextOptions, format: Format) -> Result<()> {
    if options.is_given() && !matches!(format, Format::Text | Format::OtherText) {
        let what = "options of columns, separators and comments";
        return Err(Error::usage(format!("{what} are for points as text: this is {}", format.name())));
    }
    Ok(())
}

/// Reads the header of a file.
fn open_points(file: &Opening, notices: &mut Vec<String>) -> Result<Content> {
    let Opening { options, format, .. } = file;
    if let Some(kind) = options.raw {
        return raw::open(&file.origin.view()?, kind, options.salvage);
    }
    check_text_options(&options.text, *format)?;
    let no_points = || Error::usage(format!("{} holds no points of space", format.name()));
    format.row().points.ok_or_else(no_points)?(file, notices)
}

/// What the header of a file states.
pub(crate) fn stated_of(path: &Path, options: &SourceOptions, notices: &mut Vec<String>) -> Result<Stated> {
    Source::open(path, options, notices).map(|source| source.content.stated)
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
