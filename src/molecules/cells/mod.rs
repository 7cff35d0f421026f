//! Voronoi and Laguerre (power) cells of points, in a periodic box or in all of space.
//!
//! In a box, points are triangulated with their images around it. Whether enough images were taken is tested
//! on the result, cell by cell: then each cell is that of the diagram of all images, without end.
//! `lattice` reduces the box, `images` repeats points, `star` measures a cell.

pub(crate) mod images;
pub(crate) mod lattice;
mod star;

use crate::balls::check_numbers;
use images::{Image, Repeated};
use lattice::Lattice;
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay3::{Kernel, NONE, Tetrahedralization};
use spmesh_delaunay::parallel;
use spmesh_delaunay::predicates::Point3;
use spmesh_delaunay::vector::{difference, dot};
use star::{Measure, Needed, Stars};
use std::borrow::Cow;
use std::num::NonZeroUsize;

/// Sites, and the box that repeats them.
#[derive(Debug, Clone, Copy)]
pub struct Sites<'s> {
    /// Where they are, also outside of the box.
    pub points: &'s [Point3],
    /// Their radii, one for each, not negative; empty for Voronoi cells. The weight of a site is the square.
    pub radii: &'s [f64],
    /// The three vectors of the box, if there is one: finite and not in a plane, as those of
    /// [`PeriodicBox`](spmesh_formats::molecules::PeriodicBox).
    pub periodic_box: Option<[Point3; 3]>,
}

/// What the cell of a site is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum State {
    /// A polyhedron.
    #[default]
    Bounded,
    /// It reaches to infinity: without a box, that of a site on the hull.
    Unbounded,
    /// Others take all of it: with radii only.
    Empty,
    /// Another site is at the same place, and has the cell: one with the greatest radius, the first of these.
    Duplicate,
    /// Not known, as all sites are in a plane; there is no box.
    Flat,
}

impl State {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            State::Bounded => "bounded",
            State::Unbounded => "unbounded",
            State::Empty => "empty",
            State::Duplicate => "duplicate",
            State::Flat => "flat",
        }
    }
}

/// The cell of a site.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SiteCell {
    /// What it is. Numbers are those of bounded cells; else they are 0, and those of unbounded ones infinite.
    pub state: State,
    /// Volume.
    pub volume: f64,
    /// Area of all faces.
    pub area: f64,
    /// Number of faces.
    pub faces: u32,
    /// Volume of all tetrahedra around the site.
    pub star: f64,
    /// Number of sites at this place.
    pub sites: u32,
}

impl SiteCell {
    /// The density at the site, as the Delaunay Tessellation Field Estimator has it: the number of sites here
    /// times four, over the volume of the tetrahedra around. `None` if this is cut off or not known.
    ///
    /// Domain: cells without radii.
    ///
    /// Source: Schaap and van de Weygaert, "Continuous fields and discrete samples", 2000.
    pub fn density(&self) -> Option<f64> {
        (self.star > 0.0 && self.state != State::Unbounded).then(|| 4.0 * f64::from(self.sites) / self.star)
    }
}

/// A face between two cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SiteFace {
    /// The sites. The first is not greater than the second.
    pub sites: [u32; 2],
    /// Which image of the second is a neighbour of the first: so many vectors of the box from where it is.
    /// If both are the same site, the first number that is not 0 is positive.
    pub shift: [i64; 3],
    /// Distance of the two.
    pub distance: f64,
    /// Area; infinite if it reaches to infinity.
    pub area: f64,
}

impl SiteFace {
    /// Whether this is the face to list: each is found from both sites, and twice from a site and its image.
    pub(crate) fn is_listed(&self) -> bool {
        let [first, second] = self.sites;
        (first, [0; 3]) < (second, self.shift)
    }
}

/// Cells of sites.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SiteCells {
    /// One for each site.
    pub cells: Vec<SiteCell>,
    /// Their faces, each once, in the order of sites and shifts.
    pub faces: Vec<SiteFace>,
}

/// Vertices that a thread measures at a time.
const BLOCK: usize = 4096;

/// The first margin, in cubic roots of the volume for each point: enough for random points, mostly.
const FIRST_MARGIN: f64 = 3.2;

/// Images of the first round: at most so many for each site, and so many more.
const FIRST_IMAGES: [f64; 2] = [4.0, 4096.0];

/// A margin grows by this factor if cells are open beyond it. With few sites it is the whole box at once.
const GROWTH: f64 = 4.0;
const FEW: usize = 10_000;

/// Rounds of images; more than the logarithm of the greatest number.
const ROUNDS_MAX: usize = 100;

/// Measures the cells of sites, and lists their faces if `with_faces`.
///
/// Sites are moved into the box, and rounded with it to a grid of 2^-52 of the extent of all images. Volumes
/// and areas then have an error of about 1e-14 of those of their cell, and more where sites nearly coincide.
/// The result does not depend on the number of threads; other vectors that span the same lattice, and sites
/// moved together, change no more than rounding.
///
/// # Errors
/// As [`spmesh_delaunay::delaunay3::Kernel::triangulate_weighted`]; usage, if a number is above 1e60, a site
/// is more than 1e9 boxes away, or the box would need too many images
/// ([`images_max`](spmesh_base::limits::images_max)).
///
/// Cost: O(n) for sites that are spread evenly: about twice the time of the triangulation. Memory: about 300
/// bytes per site or image, and 56 per face.
///
/// # Panics
/// If there are radii, but not one for each site.
pub fn cells(sites: Sites<'_>, with_faces: bool, threads: NonZeroUsize) -> Result<SiteCells> {
    assert!(sites.radii.is_empty() || sites.radii.len() == sites.points.len(), "a radius for each site");
    check_numbers(sites.points, sites.radii)?;
    if sites.points.is_empty() {
        return Ok(SiteCells::default());
    }
    match sites.periodic_box {
        Some(vectors) => in_box(sites, Lattice::new(vectors), with_faces, threads),
        None => {
            let diagram = Diagram::new(sites, None, Vec::new(), threads)?;
            Ok(diagram.measure(with_faces, threads)?.0)
        }
    }
}

fn in_box(
    sites: Sites<'_>,
    mut lattice: Lattice,
    with_faces: bool,
    threads: NonZeroUsize,
) -> Result<SiteCells> {
    let enough = enough(&lattice, sites.radii);
    lattice.put_on_grid(enough);
    let spacing = (lattice.volume() / sites.points.len() as f64).cbrt();
    let repeated = Repeated::new(lattice, sites.points)?;
    let first = repeated.lattice().extents(FIRST_MARGIN * spacing);
    let mut margins = affordable([0, 1, 2].map(|axis| first[axis].min(enough[axis])), sites.points.len());
    let least: f64 = if sites.points.len() < FEW { 1.0 } else { 0.0 };
    for _ in 0..ROUNDS_MAX {
        let images = repeated.images(margins)?;
        let (cells, needed) =
            Diagram::new(sites, Some(&repeated), images, threads)?.measure(with_faces, threads)?;
        let next = if needed.is_open.contains(&true) {
            let grown = |margin: f64| least.max(GROWTH * margin);
            let grown = [0, 1, 2].map(|axis| if needed.is_open[axis] { grown(margins[axis]) } else { 0.0 });
            let grown = [0, 1, 2].map(|axis| margins[axis].max(grown[axis]).min(enough[axis]));
            if margins == enough {
                break;
            }
            if grown == margins { enough } else { grown }
        } else {
            [0, 1, 2].map(|axis| margins[axis].max(needed.margins[axis].min(enough[axis])))
        };
        if next == margins {
            return Ok(cells);
        }
        margins = next;
    }
    Err(Error::usage("the cells in this box cannot be told from rounding: its sides are too different"))
}

/// Margins, less where they would mean too many images to begin with: in a box that is far from a cube.
fn affordable(mut margins: Point3, sites: usize) -> Point3 {
    let copies = |margins: Point3| margins.iter().map(|margin| 1.0 + 2.0 * margin).product::<f64>() - 1.0;
    let [each, more] = FIRST_IMAGES;
    while copies(margins) > each + more / sites as f64 {
        margins = margins.map(|margin| 0.8 * margin);
    }
    margins
}

/// Margins beyond which no image can matter, in fractional coordinates.
///
/// The images of a site are a lattice of equal weights: so a point of its cell is at most the covering radius
/// from it, and the ball around this point that can hold another site reaches less than that and the root of
/// its square and the difference of weights beyond the site.
fn enough(lattice: &Lattice, radii: &[f64]) -> Point3 {
    let covering = lattice.covering_radius();
    let weights = || radii.iter().map(|radius| radius * radius);
    let heavier = weights().fold(0.0, f64::max) - weights().fold(f64::INFINITY, f64::min).min(f64::MAX);
    let reach = covering + (covering * covering + heavier.max(0.0)).sqrt();
    lattice.extents(reach).map(|margin| margin * (1.0 + 1e-4) + 1e-4)
}

/// The triangulation of sites and images.
struct Diagram<'s> {
    count: usize,
    repeated: Option<&'s Repeated>,
    images: Vec<Image>,
    /// For each site and image.
    radii: Vec<f64>,
    mesh: Tetrahedralization,
}

/// What is known of some cells.
#[derive(Default)]
struct Part {
    cells: Vec<(u32, SiteCell)>,
    faces: Vec<SiteFace>,
    needed: Needed,
}

impl<'s> Diagram<'s> {
    fn new(
        sites: Sites<'s>,
        repeated: Option<&'s Repeated>,
        images: Vec<Image>,
        threads: NonZeroUsize,
    ) -> Result<Diagram<'s>> {
        let points = match repeated {
            None => Cow::Borrowed(sites.points),
            Some(repeated) => {
                let mut points = Vec::with_capacity(sites.points.len() + images.len());
                points.extend(repeated.in_box());
                points.extend(images.iter().map(|&image| repeated.place(image)));
                Cow::Owned(points)
            }
        };
        let mut radii = sites.radii.to_vec();
        if !radii.is_empty() {
            radii.extend(images.iter().map(|image| sites.radii[image.point as usize]));
        }
        let (mut mesh, mut kernel) = (Tetrahedralization::default(), Kernel::new());
        kernel.threads = threads;
        let done = if radii.is_empty() {
            kernel.triangulate(points, &mut mesh)
        } else {
            let weights: Vec<f64> = radii.iter().map(|radius| radius * radius).collect();
            kernel.triangulate_weighted(points, &weights, &mut mesh)
        };
        done.map_err(Error::of_computation)?;
        Ok(Diagram { count: sites.points.len(), repeated, images, radii, mesh })
    }

    /// The cells of all sites, and how many images they need.
    fn measure(&self, with_faces: bool, threads: NonZeroUsize) -> Result<(SiteCells, Needed)> {
        let mesh = &self.mesh;
        if mesh.tetrahedra().is_empty() {
            return Ok((self.flat(), Needed { is_open: [true; 3], ..Needed::default() }));
        }
        let mut starts = vec![NONE; mesh.vertices().len()];
        for (t, tetrahedron) in (0..).zip(mesh.tetrahedra()) {
            tetrahedron.vertices.iter().for_each(|&v| starts[v as usize] = t);
        }
        let heaviest = self.radii.iter().fold(0.0, |most: f64, &radius| most.max(radius * radius));
        // One set of buffers for each thread, not for each block.
        let blocks = starts.len().div_ceil(BLOCK);
        let shares = threads.get().min(blocks);
        let parts = parallel::map(threads, 0..shares, |share| -> Result<Part> {
            let (first, last) = (share * blocks / shares, (share + 1) * blocks / shares);
            let vertices = first * BLOCK..(last * BLOCK).min(starts.len());
            Ok(self.part(vertices, &starts, heaviest, with_faces))
        })?;
        let (mut all, mut needed) = (SiteCells::default(), Needed::default());
        all.cells = vec![SiteCell { state: State::Duplicate, ..SiteCell::default() }; self.count];
        for part in parts {
            part.cells.into_iter().for_each(|(site, cell)| all.cells[site as usize] = cell);
            all.faces.extend(part.faces);
            needed.add(&part.needed);
        }
        self.count_duplicates(&mut all.cells);
        all.faces.sort_unstable_by_key(|face| (face.sites, face.shift));
        Ok((all, needed))
    }

    /// The cells of sites among these vertices.
    fn part(
        &self,
        vertices: std::ops::Range<usize>,
        starts: &[u32],
        heaviest: f64,
        with_faces: bool,
    ) -> Part {
        let (mut part, mut stars) = (Part::default(), Stars::new(&self.mesh, &self.radii));
        for v in vertices {
            let site = self.mesh.vertices()[v].index;
            if site as usize >= self.count {
                continue;
            }
            let mut cell = SiteCell { state: State::Empty, sites: 1, ..SiteCell::default() };
            if starts[v] != NONE {
                let Measure { volume, area, faces, star } = stars.measure(v as u32, starts[v]);
                let state = if volume.is_finite() { State::Bounded } else { State::Unbounded };
                cell = SiteCell { state, volume, area, faces, star, sites: 1 };
                if let Some(repeated) = self.repeated {
                    part.needed.add(&stars.needed(v as u32, repeated.lattice(), heaviest));
                }
                if with_faces {
                    self.add_faces(v, &stars, &mut part.faces);
                }
            }
            part.cells.push((site, cell));
        }
        part
    }

    /// Adds the faces of a cell of which its site is the first.
    fn add_faces(&self, v: usize, stars: &Stars<'_>, faces: &mut Vec<SiteFace>) {
        let vertex = &self.mesh.vertices()[v];
        for face in stars.faces().iter().filter(|face| face.area > 0.0) {
            let other = &self.mesh.vertices()[face.vertex as usize];
            let image = (other.index as usize).checked_sub(self.count).map(|image| self.images[image]);
            let (second, shift) = match (image, self.repeated) {
                (Some(image), Some(repeated)) => (image.point, repeated.shift(vertex.index, image)),
                (None, Some(repeated)) => (other.index, repeated.shift_in_box(vertex.index, other.index)),
                _ => (other.index, [0; 3]),
            };
            let between = difference(other.at, vertex.at);
            let (sites, distance) = ([vertex.index, second], dot(between, between).sqrt());
            let face = SiteFace { sites, shift, distance, area: face.area };
            if face.is_listed() {
                faces.push(face);
            }
        }
    }

    /// Gives sites at one place their number, and the star of the one that has the cell.
    fn count_duplicates(&self, cells: &mut [SiteCell]) {
        let is_site = |pair: &&[u32; 2]| pair.iter().all(|&site| (site as usize) < self.count);
        let pairs = || self.mesh.duplicates.iter().filter(is_site);
        pairs().for_each(|&[_, of]| cells[of as usize].sites += 1);
        for &[site, of] in pairs() {
            let SiteCell { star, sites, state, .. } = cells[of as usize];
            // Of an unbounded cell, tetrahedra are missing.
            let star = if state == State::Unbounded { 0.0 } else { star };
            cells[site as usize] = SiteCell { state: State::Duplicate, star, sites, ..SiteCell::default() };
        }
    }

    /// Cells of sites in a plane.
    fn flat(&self) -> SiteCells {
        let cells = vec![SiteCell { state: State::Flat, sites: 1, ..SiteCell::default() }; self.count];
        SiteCells { cells, faces: Vec::new() }
    }
}
