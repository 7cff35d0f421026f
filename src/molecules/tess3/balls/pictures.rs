//! Surfaces, contacts and pockets as coloured meshes for programs that draw.

use std::collections::HashMap;
use std::io::Write;

use super::tables::distance_of;
use super::{BallOptions, Molecule};
use crate::balls::{
    Balls, Cell, FINEST, Surface, faces, linings, measure, molecular_mesh, molecular_surface, pockets,
    surface,
};
use crate::tess3::Product;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point3;
use spmesh_formats::molecules::AtomView;
use spmesh_formats::sink::{Mesh, Shape, Table};
use spmesh_stream::model::attributes::{Attribute, Attributes, NumberType};

/// Kinds of pockets.
const VOID: u8 = 0;
const POCKET: u8 = 1;

/// A mesh, or atoms, instead of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureOptions {
    /// The file format.
    pub form: PictureForm,
    /// Greatest distance of neighbouring vertices, in Å.
    pub resolution: f64,
    /// What the colours of a surface or of contacts tell.
    pub colours: ColourBy,
}

/// File formats of meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureForm {
    /// VTK's XML.
    Vtu,
    /// Binary PLY.
    Ply,
    /// PDB, with values of atoms as temperature factors, or with spheres of pockets.
    Pdb,
    /// mmCIF, with values of atoms as temperature factors.
    Mmcif,
    /// Values of atoms as attributes of ChimeraX.
    Defattr,
}

impl PictureForm {
    /// Whether it has atoms, not a mesh.
    pub fn is_of_atoms(self) -> bool {
        matches!(self, PictureForm::Pdb | PictureForm::Mmcif | PictureForm::Defattr)
    }
}

/// What colours tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColourBy {
    /// The element of an atom.
    Element,
    /// The chain of an atom; of contacts the pair of chains.
    Chain,
    /// The pocket around which a triangle of the surface lies.
    Pocket,
}

/// Most vertices of a surface, by their estimated number. Each takes 200 bytes.
const VERTICES_MAX: f64 = 2e7;

/// The picture of the atoms of a molecule.
pub(super) struct Picture<'p> {
    pub(super) molecule: &'p Molecule<'p>,
    pub(super) options: &'p BallOptions,
    pub(super) picture: PictureOptions,
    pub(super) balls: Balls<'p>,
}

impl Picture<'_> {
    /// Writes the mesh of a product. Returns the number of atoms that it lacks.
    pub(super) fn write(&self, product: Product, output: &mut impl Write) -> Result<u64> {
        if (product, self.picture.form) == (Product::Pockets, PictureForm::Vtu) {
            return self.bodies(output).map(|()| 0);
        }
        self.check()?;
        if product == Product::ContactAreas {
            return self.contacts(output).map(|()| 0);
        }
        if product == Product::Surface {
            return self.molecular_surface(output).map(|()| 0);
        }
        let cells = measure(self.balls, None, self.options.threads)?.cells;
        self.check_size(&cells, 1.0)?;
        self.surface(product == Product::Pockets, &cells, output)
    }

    /// The surface; of pockets only the part around these.
    fn surface(&self, only_pockets: bool, cells: &[Cell], output: &mut impl Write) -> Result<u64> {
        let (step, threads) = (self.step(), self.options.threads);
        let by_pocket = only_pockets || self.picture.colours == ColourBy::Pocket;
        let (mut surface, mut of_triangles) = if by_pocket {
            let (surface, _, around) = linings(self.balls, step, threads)?;
            (surface, around)
        } else {
            let surface = surface(self.balls, step, threads)?;
            let none = vec![0; surface.triangles.len()];
            (surface, none)
        };
        let left_out = surface.left_out as u64;
        if only_pockets {
            surface.retain(|triangle| of_triangles[triangle] > 0);
            of_triangles.retain(|&pocket| pocket > 0);
        }
        self.put_surface(&surface, by_pocket.then_some(&of_triangles), only_pockets, cells, output)?;
        Ok(left_out)
    }

    /// The surface over which the probe rolls.
    fn molecular_surface(&self, output: &mut impl Write) -> Result<()> {
        let probe = self.molecule.length(self.options.probe);
        let cells = molecular_surface(self.balls, probe, self.options.threads)?;
        // Each cube at the surface has some vertices on its edges.
        self.check_size(&cells, 4.0)?;
        // Without a probe it is that of the balls.
        let surface = if probe > 0.0 {
            molecular_mesh(self.balls, probe, self.step(), self.options.threads)?
        } else {
            surface(self.balls, self.step(), self.options.threads)?
        };
        self.put_surface(&surface, None, false, &cells, output)
    }

    /// Writes a surface; its triangles may have pockets.
    fn put_surface(
        &self,
        surface: &Surface,
        of_triangles: Option<&Vec<u32>>,
        only_pockets: bool,
        cells: &[Cell],
        output: &mut impl Write,
    ) -> Result<()> {
        let by_pocket = of_triangles.is_some();
        let pocket = |triangle: usize| of_triangles.map_or(0, |pockets| pockets[triangle]);
        let atoms = Atoms::new(self);
        let colour = |ball: u32, pocket: u32| {
            if by_pocket { of_number(pocket) } else { atoms.colour(ball, self.picture.colours) }
        };
        let mut of_points = Rows::new(&self.vertex_attributes(&atoms))?;
        for (&owner, normal) in surface.owners.iter().zip(&surface.normals) {
            normal.iter().for_each(|&c| of_points.put(&(c as f32).to_le_bytes()));
            // Only triangles know their pocket.
            of_points.put(&colour(owner, if only_pockets { 1 } else { 0 }));
            of_points.put(&atoms.serial(owner));
        }
        let mut of_cells = Rows::new(
            &[
                &[colour_attribute(), atoms.serial_attribute("serial")][..],
                &ATOM.map(|(name, number)| Attribute::new(name, number)),
                &[Attribute::new("area", NumberType::F64)],
                &if by_pocket { vec![Attribute::new("pocket", NumberType::I32)] } else { Vec::new() },
            ]
            .concat(),
        )?;
        for (triangle, &ball) in surface.balls.iter().enumerate() {
            let pocket = pocket(triangle);
            of_cells.put(&colour(ball, pocket));
            of_cells.put(&atoms.serial(ball));
            of_cells.put(&atoms.row(ball));
            of_cells.put(&(cells[ball as usize].area * self.molecule.scale.powi(2)).to_le_bytes());
            if by_pocket {
                of_cells.put(&pocket.to_le_bytes());
            }
        }
        let corners = surface.triangles.as_flattened();
        self.put(&surface.points, Shape::Triangles, corners, [of_points, of_cells], output)
    }

    /// The faces between atoms.
    fn contacts(&self, output: &mut impl Write) -> Result<()> {
        let between = self.options.contacts.between.as_ref();
        let parts = between.map(|between| between.parts(self.molecule.selected)).transpose()?;
        let faces = faces(self.balls, self.step(), |contact| {
            let [p, q] = contact.balls.map(|ball| ball as usize);
            let distance = distance_of(self.molecule, contact.balls) * self.molecule.scale;
            parts.as_ref().is_none_or(|parts| parts[p] != parts[q])
                && self.options.contacts.within.is_none_or(|most| distance <= most)
                && contact.area * self.molecule.scale.powi(2) >= self.options.contacts.min_area
        })?;
        let atoms = Atoms::new(self);
        let mut of_cells = Rows::new(&[
            colour_attribute(),
            atoms.serial_attribute("serial1"),
            atoms.serial_attribute("serial2"),
            Attribute::new("chain1", NumberType::I32),
            Attribute::new("chain2", NumberType::I32),
            Attribute::new("area", NumberType::F64),
        ])?;
        let mut pairs: HashMap<[u32; 2], u32> = HashMap::new();
        for contact in &faces.contacts {
            let mut chains = contact.balls.map(|ball| atoms.chains[ball as usize]);
            let [first, second] = chains;
            chains.sort_unstable();
            let next = pairs.len() as u32 + 1;
            let pair = if first == second { 0 } else { *pairs.entry(chains).or_insert(next) };
            of_cells.put(&of_number(pair));
            contact.balls.iter().for_each(|&ball| of_cells.put(&atoms.serial(ball)));
            [first, second].iter().for_each(|chain| of_cells.put(&chain.to_le_bytes()));
            of_cells.put(&(contact.area * self.molecule.scale.powi(2)).to_le_bytes());
        }
        let tables = [Rows::new(&[])?, of_cells];
        self.put(&faces.points, Shape::Polygons(&faces.ends), &faces.corners, tables, output)
    }

    /// The tetrahedra of pockets.
    fn bodies(&self, output: &mut impl Write) -> Result<()> {
        let found = pockets(self.balls)?;
        let atoms = Atoms::new(self);
        let mut numbers: HashMap<u32, u32> = HashMap::new();
        let (mut points, mut corners) = (Vec::new(), Vec::new());
        let mut of_points = Rows::new(&[atoms.serial_attribute("serial")])?;
        let mut of_cells = Rows::new(&[
            colour_attribute(),
            Attribute::new("pocket", NumberType::I32),
            Attribute::new("kind", NumberType::U8),
            Attribute::new("volume", NumberType::F64),
        ])?;
        for (number, pocket) in (1u32..).zip(&found) {
            let kind = if pocket.mouths.is_empty() { VOID } else { POCKET };
            let volume = pocket.volume * self.molecule.scale.powi(3);
            for ball in pocket.tetrahedra.as_flattened() {
                let vertex = *numbers.entry(*ball).or_insert_with(|| {
                    points.push(self.balls.centres[*ball as usize]);
                    of_points.put(&atoms.serial(*ball));
                    points.len() as u32 - 1
                });
                corners.push(vertex);
            }
            for _ in &pocket.tetrahedra {
                of_cells.put(&of_number(number));
                of_cells.put(&number.to_le_bytes());
                of_cells.put(&[kind]);
                of_cells.put(&volume.to_le_bytes());
            }
        }
        self.put(&points, Shape::Tetrahedra, &corners, [of_points, of_cells], output)
    }

    fn put(
        &self,
        stored: &[Point3],
        shape: Shape<'_>,
        corners: &[u32],
        [of_points, of_cells]: [Rows; 2],
        output: &mut impl Write,
    ) -> Result<()> {
        let coordinates = self.molecule.selected.structure().coordinates;
        let points: Vec<Point3> = stored.iter().map(|&point| coordinates.to_world(point)).collect();
        let mesh = Mesh { points: &points, shape, corners, of_points: of_points.0, of_cells: of_cells.0 };
        match self.picture.form {
            PictureForm::Vtu => mesh.write_vtu(output),
            _ => mesh.write_ply(output),
        }
    }

    fn check(&self) -> Result<()> {
        let greatest = self.balls.radii.iter().copied().fold(0.0, f64::max);
        let least = greatest / FINEST * self.molecule.scale;
        let resolution = self.picture.resolution;
        if resolution > 0.0 && resolution >= least {
            return Ok(());
        }
        let least = (1e4 * least).ceil() / 1e4;
        Err(Error::usage(format!("--resolution {resolution} is too fine: here the least is {least:.4} Å")))
    }

    /// Refuses too many vertices; the mesh has `density` times those of triangles with sides of the
    /// resolution.
    fn check_size(&self, cells: &[Cell], density: f64) -> Result<()> {
        let area: f64 = cells.iter().map(|cell| cell.area).sum();
        // Of triangles with sides of the resolution, each vertex has two.
        let vertices = density * area / (0.75f64.sqrt() * self.step() * self.step());
        if vertices <= VERTICES_MAX {
            return Ok(());
        }
        let (resolution, millions) = (self.picture.resolution, (vertices / 1e6).ceil());
        let remedy = resolution * (vertices / VERTICES_MAX).sqrt();
        Err(Error::usage(format!(
            "at --resolution {resolution} the surface has some {millions} million vertices: give at least \
             {:.4}",
            (1e4 * remedy).ceil() / 1e4
        )))
    }

    /// The resolution in stored units.
    fn step(&self) -> f64 {
        self.picture.resolution / self.molecule.scale
    }

    /// Attributes of the vertices of a surface; each format has its own names of normals.
    fn vertex_attributes(&self, atoms: &Atoms<'_>) -> Vec<Attribute> {
        let mut attributes = match self.picture.form {
            PictureForm::Vtu => {
                vec![Attribute { components: 3, ..Attribute::new("Normals", NumberType::F32) }]
            }
            _ => ["nx", "ny", "nz"].map(|name| Attribute::new(name, NumberType::F32)).to_vec(),
        };
        attributes.extend([colour_attribute(), atoms.serial_attribute("serial")]);
        attributes
    }
}

/// The attributes of an atom that are numbers: its element, and the numbers of its chain, from 1 in the order
/// of the file, and of its residue.
const ATOM: [(&str, NumberType); 3] =
    [("element", NumberType::U8), ("chain", NumberType::I32), ("residue", NumberType::I32)];

fn colour_attribute() -> Attribute {
    Attribute { components: 3, ..Attribute::new("rgb", NumberType::U8) }
}

/// Numbers of atoms.
struct Atoms<'p> {
    picture: &'p Picture<'p>,
    elements: Vec<u8>,
    /// Numbers of chains, from 1.
    chains: Vec<u32>,
    /// Serial numbers need 64 bits.
    are_long: bool,
}

impl<'p> Atoms<'p> {
    fn new(picture: &'p Picture<'p>) -> Self {
        let selected = picture.molecule.selected;
        let views = || (0..selected.points().len()).map(|index| selected.atom(index));
        let mut numbers: HashMap<u32, u32> = HashMap::new();
        let mut number = |atom: AtomView<'_>| {
            let next = numbers.len() as u32 + 1;
            *numbers.entry(atom.residue().chain_number).or_insert(next)
        };
        Atoms {
            picture,
            elements: views().map(|atom| atom.map_or(0, |atom| atom.atom.atomic_number)).collect(),
            chains: views().map(|atom| atom.map_or(0, &mut number)).collect(),
            are_long: (0..selected.points().len()).any(|index| i32::try_from(selected.label(index)).is_err()),
        }
    }

    fn serial_attribute(&self, name: &str) -> Attribute {
        Attribute::new(name, if self.are_long { NumberType::U64 } else { NumberType::I32 })
    }

    /// The bytes of a serial number.
    fn serial(&self, ball: u32) -> Vec<u8> {
        let serial = self.picture.molecule.selected.label(ball as usize);
        if self.are_long { serial.to_le_bytes().to_vec() } else { (serial as u32).to_le_bytes().to_vec() }
    }

    /// The bytes of the attributes [`ATOM`].
    fn row(&self, ball: u32) -> [u8; 9] {
        let atom = self.picture.molecule.selected.atom(ball as usize);
        let residue = atom.and_then(|atom| atom.residue_number()).unwrap_or_default();
        let mut row = [self.elements[ball as usize]; 9];
        row[1..5].copy_from_slice(&self.chains[ball as usize].to_le_bytes());
        row[5..].copy_from_slice(&residue.to_le_bytes());
        row
    }

    fn colour(&self, ball: u32, by: ColourBy) -> Colour {
        match by {
            ColourBy::Element => of_element(self.elements[ball as usize]),
            ColourBy::Chain | ColourBy::Pocket => of_number(self.chains[ball as usize]),
        }
    }
}

/// A table that grows.
struct Rows(Table);

impl Rows {
    fn new(attributes: &[Attribute]) -> Result<Rows> {
        let attributes = Attributes::new(attributes.to_vec()).map_err(Error::usage)?;
        Ok(Rows(Table { attributes, rows: Vec::new() }))
    }

    fn put(&mut self, bytes: &[u8]) {
        self.0.rows.extend_from_slice(bytes);
    }
}

/// Red, green and blue.
pub(super) type Colour = [u8; 3];

/// What has no colour of its own.
pub(super) const GREY: Colour = [200, 200, 205];

/// Colours that differ clearly, next to each other in pairs of chains and of pockets.
const DISTINCT: [Colour; 10] = [
    [86, 156, 214],
    [230, 140, 40],
    [60, 160, 120],
    [204, 105, 165],
    [120, 110, 200],
    [190, 80, 60],
    [150, 190, 80],
    [80, 185, 200],
    [220, 180, 90],
    [150, 120, 100],
];

/// The colour of the element with an atomic number, after Corey, Pauling and Koltun (CPK).
pub(super) fn of_element(number: u8) -> Colour {
    match number {
        1 => [240, 240, 240],
        6 => [190, 190, 192],
        7 => [90, 115, 225],
        8 => [225, 80, 70],
        9 | 17 => [90, 200, 90],
        15 => [235, 150, 60],
        16 => [230, 200, 80],
        26 => [205, 105, 60],
        35 | 53 => [150, 70, 60],
        0 => GREY,
        _ => [160, 130, 190],
    }
}

/// A colour for a number from 1 on; grey for 0.
pub(super) fn of_number(number: u32) -> Colour {
    number.checked_sub(1).map_or(GREY, |index| DISTINCT[index as usize % DISTINCT.len()])
}
