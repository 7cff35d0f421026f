//! Streams of points as a finalizer could write them, and meshes read back, all in memory.

use std::io::Cursor;

use spmesh_base::error::Result;
use spmesh_pipeline::reduce::{Options, Stats};
use spmesh_stream::model::bounds::{Bounds, Point};
use spmesh_stream::model::cells::{CellCode, CellTree};
use spmesh_stream::{Coordinates, Event, Header, Kind, LiveVertices, StreamReader, StreamWriter};

use spmesh_reference::sets::Random;

/// The unit grid, with integer coordinates as in LAS files.
pub const GRID: Coordinates = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };

/// How the points of a stream are cut into cells, and when the cells are tagged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tagging {
    /// No tree.
    None,
    /// A tree, but no tags.
    Never,
    /// Cells of one level in random order; the points of each come right before its tag.
    Chunked(u8),
    /// Chunked cells of random levels; parents are sometimes tagged after some of their children.
    Ragged,
    /// Points in the given order; each deepest cell is tagged after its last point.
    Preserved(u8),
    /// Like `Preserved`, but some cells are never tagged.
    Forgetful(u8),
}

/// A stream of points in the plane with the given cells.
pub fn stream(points: &[Point], coordinates: Coordinates, tagging: Tagging, random: &mut Random) -> Vec<u8> {
    stream_of(2, points, coordinates, tagging, random)
}

/// A stream of points in two or three dimensions with the given cells.
pub fn stream_of(
    dims: u8,
    points: &[Point],
    coordinates: Coordinates,
    tagging: Tagging,
    random: &mut Random,
) -> Vec<u8> {
    let mut header = Header::new(Kind::Points, coordinates, dims, dims == 2);
    header.bounds = Bounds::of_points(points);
    header.points = Some(points.len() as u64);
    let depth = match tagging {
        Tagging::None => 0,
        Tagging::Never => 3,
        // An octree of six levels has a quarter of a million cells.
        Tagging::Ragged => {
            if dims == 2 {
                6
            } else {
                3
            }
        }
        Tagging::Chunked(level) | Tagging::Preserved(level) | Tagging::Forgetful(level) => level,
    };
    let bounds = header.bounds.unwrap_or(Bounds::of_point([0.0; 3]));
    header.tree = CellTree::covering(&bounds, dims, depth).filter(|_| tagging != Tagging::None);
    let mut writer = StreamWriter::new(Vec::new(), header).unwrap();
    match (writer.header().tree, tagging) {
        (None, _) | (_, Tagging::None | Tagging::Never) => writer.points(points).unwrap(),
        (Some(tree), Tagging::Chunked(level)) => {
            let mut cells: Vec<CellCode> = tree.deepest_range(CellCode::ROOT).map(CellCode).collect();
            assert_eq!(tree.depth(), level);
            random.shuffle(&mut cells);
            for cell in cells {
                write_cell(&mut writer, &tree, points, cell);
            }
        }
        (Some(tree), Tagging::Ragged) => ragged(&mut writer, &tree, points, CellCode::ROOT, random),
        (Some(tree), Tagging::Preserved(_)) => preserved(&mut writer, &tree, points, |_| true),
        (Some(tree), Tagging::Forgetful(_)) => preserved(&mut writer, &tree, points, |cell| cell.0 % 3 != 1),
    }
    writer.end(0, 0).unwrap()
}

fn inside(tree: &CellTree, cell: CellCode, point: Point) -> bool {
    let (min, max) = tree.corners(cell);
    (0..usize::from(tree.dims())).all(|axis| min[axis] <= point[axis] && point[axis] < max[axis])
}

fn write_cell(writer: &mut StreamWriter<Vec<u8>>, tree: &CellTree, points: &[Point], cell: CellCode) {
    let points: Vec<Point> = points.iter().copied().filter(|&point| inside(tree, cell, point)).collect();
    writer.points(&points).unwrap();
    writer.cells(&[cell]).unwrap();
}

/// Tags `cell` in random pieces: the cell at once, only its children, or some children and then the cell.
fn ragged(
    writer: &mut StreamWriter<Vec<u8>>,
    tree: &CellTree,
    points: &[Point],
    cell: CellCode,
    random: &mut Random,
) {
    let choice = random.integer(0, 9);
    if tree.level(cell) == tree.depth() || (choice == 0 && cell != CellCode::ROOT) {
        return write_cell(writer, tree, points, cell);
    }
    let mut children: Vec<CellCode> = tree.children(cell).collect();
    random.shuffle(&mut children);
    if choice > 3 {
        return children.into_iter().for_each(|child| ragged(writer, tree, points, child, random));
    }
    let (done, rest) = children.split_at(choice as usize);
    done.iter().for_each(|&child| ragged(writer, tree, points, child, random));
    let is_rest = |point: &Point| rest.iter().any(|&child| inside(tree, child, *point));
    let points: Vec<Point> = points.iter().copied().filter(is_rest).collect();
    writer.points(&points).unwrap();
    writer.cells(&[cell]).unwrap();
}

fn preserved(
    writer: &mut StreamWriter<Vec<u8>>,
    tree: &CellTree,
    points: &[Point],
    tagged: impl Fn(CellCode) -> bool,
) {
    let cells: Vec<CellCode> = points.iter().map(|&point| tree.cell_of(point, tree.depth())).collect();
    for (i, (&point, &cell)) in points.iter().zip(&cells).enumerate() {
        writer.points(&[point]).unwrap();
        if !cells[i + 1..].contains(&cell) && tagged(cell) {
            writer.cells(&[cell]).unwrap();
        }
    }
    let empty: Vec<CellCode> =
        tree.deepest_range(CellCode::ROOT).map(CellCode).filter(|cell| !cells.contains(cell)).collect();
    writer.cells(&empty).unwrap();
}

/// The contents of a mesh stream: its vertices, and its triangles as coordinates.
#[derive(Debug, PartialEq)]
pub struct Mesh {
    pub vertices: Vec<Point>,
    /// Sorted; each begins with its least corner, counterclockwise.
    pub triangles: Vec<[[i64; 2]; 3]>,
    pub residual: usize,
}

/// Reads a mesh and checks that every vertex is used only while it is live.
pub fn read_mesh(bytes: &[u8]) -> Mesh {
    let mut reader = StreamReader::new(bytes, "mesh").unwrap();
    let mut live = LiveVertices::new();
    let mut mesh = Mesh { vertices: Vec::new(), triangles: Vec::new(), residual: 0 };
    while let Some(event) = reader.next_event().unwrap() {
        match event {
            Event::Patch(patch) => {
                let local = live.enter(&patch, |_, point| point).unwrap();
                mesh.vertices.extend(&patch.new);
                mesh.triangles.extend(patch.triangles().map(|t| {
                    let t = t.map(|v| [local[v as usize].1[0] as i64, local[v as usize].1[1] as i64]);
                    [[t[0], t[1], t[2]], [t[1], t[2], t[0]], [t[2], t[0], t[1]]].into_iter().min().unwrap()
                }));
            }
            Event::ResidualPoints(points) => mesh.residual += points.len(),
            Event::Walls(_) | Event::End(_) => {}
            other => panic!("{other:?} in a mesh"),
        }
    }
    mesh.triangles.sort_unstable();
    mesh
}

/// Triangulates a stream of points into a mesh stream.
pub fn triangulate(points: &[u8], options: &Options) -> Result<(Vec<u8>, Stats)> {
    let reader = StreamReader::new(Cursor::new(points.to_vec()), "points")?;
    spmesh_pipeline::reduce::triangulate(reader, Vec::new(), options, |_| ())
}

/// Options of a plain run.
pub fn threads(threads: usize) -> Options {
    Options { threads, ..Options::default() }
}
