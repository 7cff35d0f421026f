//! One structure: select, triangulate, write.

use std::borrow::Cow;
use std::time::Instant;

use super::alpha::AlphaComplex;
use super::balls::{BallOptions, Molecule};
use super::filtration::Filtration;
use super::frames::run_models;
use super::identity::Origin;
use super::labels::Labels;
use super::mesh::write_mesh;
use super::tables::{ModelTables, TETRAHEDRA, columns, contact_columns};
use super::{Arithmetic, Options, PeriodicFrom, Product, Report, selection, sites};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_delaunay::delaunay3::Tetrahedralization;
use spmesh_delaunay::predicates::Point3;
use spmesh_formats::molecules::{Models, Selected, Structure};
use spmesh_formats::sink::{Column, TableSink};
use spmesh_stream::model::attributes::Attributes;
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Coordinates, Header, Kind, StreamWriter, Weighted};

/// Triangulates the selected models of a structure one by one, and writes them to outputs that `open`
/// creates: a mesh for each model, of which `open` gets the place in the file and the number, or one table
/// for all models.
///
/// Memory: beside the structure and the kernel, 8 bytes per point for a mesh; for a table some 200, and the
/// names.
///
/// # Errors
/// Usage, if the structure lacks what is selected, or the selection is empty; those of writing and of `open`.
pub fn run(structure: Structure, options: &Options, open: &mut Open<'_>) -> Result<Vec<Report>> {
    let name = structure.name.clone();
    let structure = match &options.assembly {
        Some(assembly) => structure.assembled(assembly)?,
        None => structure,
    };
    if options.is_by_models(structure.models.len()) {
        return run_models(structure, options, open).map_err(|e| e.of_input(name));
    }
    let mut job = Job { options: options.clone(), open: Some(open), table: None };
    let structure = if options.selection.models == Models::Joined {
        job.options.selection.models = Models::First;
        structure.joined()?
    } else {
        structure
    };
    let reports = job.all_models(structure).map_err(|e| e.of_input(name))?;
    if let Some(table) = job.table {
        table.commit()?;
    }
    Ok(reports)
}

/// The columns of the table that these options make.
pub(super) fn table_columns(options: &Options) -> Vec<Column> {
    let is_periodic = options.periodic.is_some();
    let names = match (options.product, &options.balls) {
        (product @ (Product::SiteCells(_) | Product::SiteFaces), balls) => {
            sites::columns(product, balls.is_some(), is_periodic)
        }
        (product, Some(balls)) => balls.columns(product, is_periodic),
        (Product::Contacts, None) => contact_columns(),
        (_, None) => TETRAHEDRA.to_string(),
    };
    // Frames are the models of a trajectory.
    columns(&if options.frames.is_some() { names.replacen("model", "frame", 1) } else { names })
}

/// Creates the output of a model, or the one of all.
pub type Open<'o> = dyn FnMut(Option<ModelName>) -> Result<Output> + Send + 'o;

/// The place and the number of a model in its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModelName {
    /// Its place in the file, from 1.
    pub place: usize,
    /// The number that the file gives it; several may have the same.
    pub number: i64,
}

/// Measures models one by one.
pub(super) struct Job<'o, 'f> {
    pub(super) options: Options,
    /// Without it, the rows of a table are held.
    pub(super) open: Option<&'o mut Open<'f>>,
    /// The table of all models.
    pub(super) table: Option<TableSink>,
}

impl Job<'_, '_> {
    fn all_models(&mut self, mut structure: Structure) -> Result<Vec<Report>> {
        if !self.options.selection.models.are_several() {
            return Ok(vec![self.model(&mut structure, 1)?]);
        }
        let wanted = structure.models_of(&self.options.selection)?;
        self.options.selection.models = Models::First;
        let mut reports = Vec::new();
        for (place, model) in std::mem::take(&mut structure.models).into_iter().enumerate() {
            if !wanted.contains(&place) {
                continue;
            }
            let place = place + 1;
            structure.models = vec![model];
            reports.push(self.model(&mut structure, place)?);
        }
        Ok(reports)
    }

    /// Triangulates the selected atoms of one model.
    pub(super) fn model(&mut self, structure: &mut Structure, place: usize) -> Result<Report> {
        let started = Instant::now();
        let at = structure.models_of(&self.options.selection)?[0];
        let name = ModelName { place, number: structure.models[at].number };
        // Points without atoms and labels move into the kernel, which then needs no copy.
        let model = &structure.models[at];
        let is_plain = self.options.product == Product::Mesh
            && self.options.balls.is_none()
            && model.atoms.is_empty()
            && model.labels.is_empty();
        if is_plain {
            selection::select(structure, &self.options.selection)?;
        }
        let plain = is_plain.then(|| std::mem::take(&mut structure.models[at].points));
        let selected =
            plain.is_none().then(|| selection::select(structure, &self.options.selection)).transpose()?;
        let selected = selected.as_ref();
        let origin = Origin { file: &structure.name, model: name.number };
        let mut report = Report::new(name.number, selected.map_or(0, |selected| selected.points().len()));
        let mut weights = None;
        let periodic_box = self.periodic_box(structure, at)?;
        let molecule = selected.map(|selected| {
            let scale = scale(structure.coordinates);
            let periodic_box = periodic_box.map(|vectors| vectors.map(|vector| vector.map(|c| c / scale)));
            Molecule { origin, selected, scale, periodic_box }
        });
        if let (Some(molecule), Product::SiteCells(_) | Product::SiteFaces) =
            (&molecule, self.options.product)
        {
            return self.write_sites(molecule, started);
        }
        if let (Some(balls), Some(molecule)) = (self.options.balls.clone(), molecule) {
            if !matches!(self.options.product, Product::Filtration | Product::Mesh) {
                return self.write_balls(&balls, &molecule, started);
            }
            weights = Some(molecule.weights(&balls, &mut report)?);
        }
        let points = match (plain, selected) {
            (Some(points), _) => Cow::Owned(points),
            (None, selected) => Cow::Borrowed(selected.map_or(&[][..], Selected::points)),
        };
        report.atoms = points.len() as u64;
        let mesh = self.options.method.triangulate(points, weights.as_deref(), &mut report)?;
        report.times.triangulate = started.elapsed();
        self.options.method.count_violations(&mesh, &mut report);
        let measured = Instant::now();
        let model = Model { name, origin, coordinates: structure.coordinates, selected };
        match (selected, self.options.product) {
            (Some(selected), Product::Tetrahedra | Product::Contacts) => {
                self.write_table(&model, selected, &mesh, &mut report)?;
            }
            (Some(selected), Product::Filtration) => {
                // Atoms count as points.
                let mut output = self.open(Some(model.name))?;
                Filtration::new(selected.points(), weights.as_deref(), &mesh)?
                    .write(&mut output, model.scale())?;
                output.commit()?;
            }
            _ => self.write_mesh(&model, mesh, weights.as_deref(), &mut report)?,
        }
        report.times.write = measured.elapsed();
        Ok(report)
    }

    /// The vectors of the box of a model, in Å, if atoms repeat.
    fn periodic_box(&self, structure: &Structure, at: usize) -> Result<Option<[Point3; 3]>> {
        let model = &structure.models[at];
        let reason = match (self.options.periodic, &model.periodic_box) {
            (None, _) => return Ok(None),
            (Some(PeriodicFrom::Stated(found)), _) => return Ok(Some(found.vectors())),
            (_, Some(Ok(found))) => return Ok(Some(found.vectors())),
            (_, Some(Err(fault))) => format!("states no periodic box that can be used ({fault})"),
            (_, None) => "states no periodic box".to_string(),
        };
        let of =
            if self.options.frames.is_some() { format!("frame {} ", model.number) } else { String::new() };
        Err(Error::usage(format!("{of}{reason}: give one with --box a,b,c,alpha,beta,gamma")))
    }

    /// Measures Voronoi or Laguerre cells, and writes rows of them or of their faces.
    fn write_sites(&mut self, molecule: &Molecule<'_>, started: Instant) -> Result<Report> {
        let mut report = Report::new(molecule.origin.model, molecule.selected.points().len());
        report.labels = Labels::of(molecule.selected, &self.options);
        report.is_of_cells = true;
        let balls = self.options.balls.as_ref();
        let radii = balls.map_or(Ok(Vec::new()), |balls| molecule.radii(balls, &mut report))?;
        let (product, threads) = (self.options.product, self.options.method.threads);
        sites::write(product, molecule, &radii, threads, &mut report, || self.table())?;
        report.times.triangulate = started.elapsed();
        Ok(report)
    }

    /// The alpha complex of the mesh, if the options ask for it.
    fn alpha<'m>(
        &self,
        model: &Model<'_>,
        mesh: &'m Tetrahedralization,
        report: &mut Report,
    ) -> Option<AlphaComplex<'m>> {
        let radius = self.options.alpha.as_ref()?;
        let alpha = AlphaComplex::new(mesh, radius.in_steps(model.scale()));
        report.tetrahedra = alpha.tetrahedra();
        Some(alpha)
    }

    fn write_table(
        &mut self,
        model: &Model<'_>,
        selected: &Selected<'_>,
        mesh: &Tetrahedralization,
        report: &mut Report,
    ) -> Result<()> {
        let alpha = self.alpha(model, mesh, report);
        let (origin, scale) = (model.origin, model.scale());
        let tables = ModelTables { origin, selected, mesh, alpha: alpha.as_ref(), scale };
        report.labels = Labels::of(selected, &self.options);
        let is_contacts = self.options.product == Product::Contacts;
        let table = self.table()?;
        if is_contacts { tables.write_contacts(table) } else { tables.write_tetrahedra(table) }
    }

    /// Measures atoms as balls, and writes rows of their cells or contacts.
    fn write_balls(
        &mut self,
        balls: &BallOptions,
        molecule: &Molecule<'_>,
        started: Instant,
    ) -> Result<Report> {
        let mut report = Report::new(molecule.origin.model, molecule.selected.points().len());
        report.labels = Labels::of(molecule.selected, &self.options);
        let product = self.options.product;
        if let Some(picture) = balls.picture {
            let mut output = self.open(None)?;
            molecule.draw(product, picture, balls, &mut report, &mut output)?;
            output.commit()?;
        } else {
            molecule.write(product, balls, &mut report, || self.table())?;
        }
        report.times.triangulate = started.elapsed();
        Ok(report)
    }

    fn open(&mut self, model: Option<ModelName>) -> Result<Output> {
        self.open.as_mut().expect("rows alone are held")(model)
    }

    /// The table, which is created when it gets its first rows.
    pub(super) fn table(&mut self) -> Result<&mut TableSink> {
        if self.table.is_none() {
            let columns = table_columns(&self.options);
            self.table = Some(match &mut self.open {
                Some(open) => TableSink::create(self.options.format, columns, open(None)?),
                None => TableSink::held(self.options.format, columns),
            });
        }
        Ok(self.table.as_mut().expect("there is one now"))
    }

    fn write_mesh(
        &mut self,
        model: &Model<'_>,
        mesh: Tetrahedralization,
        weights: Option<&[f64]>,
        report: &mut Report,
    ) -> Result<()> {
        let kept = self.alpha(model, &mesh, report).map(AlphaComplex::into_bits);
        let merged = mesh.duplicates.len() as u64;
        let points = mesh.vertices().len() as u64 + merged;
        let mut header = self.header(model.coordinates, &mesh, points);
        if let Some(weights) = weights {
            let greatest = weights.iter().copied().reduce(f64::max).unwrap_or(0.0);
            header.weighted = Some(Weighted { greatest });
            header.attributes = Attributes::new(vec![Weighted::attribute()]).map_err(Error::usage)?;
        }
        let mut writer = StreamWriter::new(self.open(Some(model.name))?, header)?;
        let is_kept = |t: usize| kept.as_ref().is_none_or(|bits| bits[t / 64] >> (t % 64) & 1 == 1);
        let mut corners =
            mesh.into_corners(is_kept, self.options.method.threads).map_err(Error::of_computation)?;
        let label = |index: u32| match model.selected {
            Some(selected) => selected.label(index as usize),
            None => u64::from(index) + 1,
        };
        write_mesh(&mut writer, &mut corners, label, weights)?;
        writer.end(points, merged)?.commit()
    }

    fn header(&self, coordinates: Coordinates, mesh: &Tetrahedralization, points: u64) -> Header {
        let mut producer = format!("tess3 {}", env!("CARGO_PKG_VERSION"));
        if let Some(radius) = &self.options.alpha {
            producer += &format!(", alpha complex of radius {radius}");
        }
        if self.options.method.arithmetic != Arithmetic::Exact {
            producer += ", in floating-point arithmetic";
        }
        Header {
            bounds: bounds(mesh),
            points: Some(points),
            compressed: self.options.compress,
            producer,
            ..Header::new(Kind::TetrahedralMesh, coordinates, 3, false)
        }
    }
}

/// The data that is written beside the mesh.
struct Model<'s> {
    name: ModelName,
    origin: Origin<'s>,
    coordinates: Coordinates,
    /// The selected atoms; `None` for plain points.
    selected: Option<&'s Selected<'s>>,
}

impl Model<'_> {
    /// World units per stored unit.
    fn scale(&self) -> f64 {
        scale(self.coordinates)
    }
}

/// World units per stored unit, which is the same for all axes of structures.
fn scale(coordinates: Coordinates) -> f64 {
    match coordinates {
        Coordinates::F64 => 1.0,
        Coordinates::I32 { scale, .. } => scale[0],
    }
}

fn bounds(mesh: &Tetrahedralization) -> Option<Bounds> {
    let (first, rest) = mesh.vertices().split_first()?;
    let mut bounds = Bounds::of_point(first.at);
    rest.iter().for_each(|vertex| bounds.extend(vertex.at));
    Some(bounds)
}
