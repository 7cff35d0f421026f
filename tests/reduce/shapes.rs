//! Shapes that a grid or a curve resolves badly take no more work than others, and little memory.

use spmesh_base::error::ErrorKind;
use spmesh_pipeline::reduce::{Options, Stats};
use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::Point;

use super::solids;
use super::streams::{Mesh, Tagging, read_mesh, stream, stream_of, threads, triangulate};
use spmesh_reference::sets::Random;

fn run(points: &[Point], tagging: Tagging) -> (Mesh, Stats) {
    let input = stream(points, Coordinates::F64, tagging, &mut Random::new(4));
    let (mesh, stats) = triangulate(&input, &threads(2)).expect("a mesh");
    (read_mesh(&mesh), stats)
}

/// Two rows of points, `gap` apart, that are one unit apart in each row, turned by the angle of `cosine` and
/// `sine`.
fn strip(count: usize, gap: f64, [cosine, sine]: [f64; 2]) -> Vec<Point> {
    let row = |i: usize| ((i / 2) as f64, gap * (i % 2) as f64);
    (0..count).map(row).map(|(x, y)| [cosine * x - sine * y, sine * x + cosine * y, 0.0]).collect()
}

fn circle(random: &mut Random, count: usize) -> Vec<Point> {
    let angles = (0..count).map(|_| std::f64::consts::PI * random.unit());
    angles.map(|angle| [angle.cos(), angle.sin(), 0.0]).collect()
}

/// Coordinates over two hundred binary orders of magnitude.
fn exponential(random: &mut Random, count: usize) -> Vec<Point> {
    (0..count).map(|_| [(100.0 * random.unit()).exp2(), (100.0 * random.unit()).exp2(), 0.0]).collect()
}

#[test]
fn no_shape_takes_much_more_decisions_than_uniform_points() {
    let mut random = Random::new(1);
    // Longer than 65,536 gaps: a grid of 16 bits does not tell the rows apart.
    let count = 160_000;
    let uniform: Vec<Point> = (0..count).map(|_| [random.unit(), random.unit(), 0.0]).collect();
    let zigzag: Vec<Point> = (0..count).map(|i| [i as f64, 1e-3 * (i % 2) as f64, 0.0]).collect();
    let shapes = [
        ("strip", strip(count, 1.0, [1.0, 0.0])),
        ("upright strip", strip(count, 1.0, [0.0, 1.0])),
        ("narrow strip", strip(count, 1e-3, [1.0, 0.0])),
        ("strip aslant", strip(count, 1.0, [0.8, 0.6])),
        ("zigzag", zigzag),
        ("circle", circle(&mut random, count)),
        ("exponential", exponential(&mut random, count)),
    ];
    let least = run(&uniform, Tagging::Chunked(2)).1.predicates.total();
    for (shape, mut points) in shapes {
        random.shuffle(&mut points);
        let decisions = run(&points, Tagging::Chunked(4)).1.predicates.total();
        assert!(decisions < 5 * least, "{shape}: {decisions} decisions, uniform points take {least}");
    }
}

#[test]
fn rows_on_the_sides_do_not_wait_for_the_end() {
    let points = strip(40_000, 1.0, [1.0, 0.0]);
    let (mesh, stats) = run(&points, Tagging::Chunked(5));
    assert_eq!(mesh.triangles.len(), 39_998);
    assert!(stats.residual_max < 4_000, "{} points waited", stats.residual_max);
    let planes: Vec<Point> =
        (0..40_000).map(|i| [(i / 2 % 141) as f64, (i / 2 / 141) as f64, f64::from(i % 2)]).collect();
    let input = stream_of(3, &planes, Coordinates::F64, Tagging::Chunked(3), &mut Random::new(5));
    let (_, stats) = solids::tetrahedralize(&input, &solids::every_node(1)).expect("a mesh");
    assert!(stats.residual_max < 20_000, "{} points waited", stats.residual_max);
    let line: Vec<Point> = (0..40_000).map(|i| [i as f64, 7.0, (i % 5) as f64]).collect();
    let (mesh, stats) = run(&line, Tagging::Chunked(5));
    assert_eq!((mesh.vertices.len(), stats.residual_max), (40_000, 0));
}

/// The triangles of the kernel over all points at once.
fn of_kernel(points: &[Point]) -> Vec<[[i64; 2]; 3]> {
    let at: Vec<[f64; 2]> = points.iter().map(|p| [p[0], p[1]]).collect();
    let mesh = spmesh_delaunay::delaunay2::triangulate(&at).expect("triangles");
    let corner = |v: u32| at[v as usize].map(|c| c as i64);
    let least_first =
        |t: [[i64; 2]; 3]| [[t[0], t[1], t[2]], [t[1], t[2], t[0]], [t[2], t[0], t[1]]].into_iter().min();
    let mut triangles: Vec<_> = mesh.simplices().filter_map(|t| least_first(t.map(corner))).collect();
    triangles.sort_unstable();
    triangles
}

#[test]
fn crowded_cells_are_divided() {
    let mut random = Random::new(2);
    // A cluster that no level of the tree resolves, with ties and coinciding points, and two points far away.
    let mut points: Vec<Point> =
        (0..300_000).map(|_| [0, 1, 2].map(|_| random.integer(0, 3_000) as f64)).collect();
    points.extend([[1e12, 1e12, 0.0], [-1e12, 1e12, 5.0]]);
    let expected = of_kernel(&points);
    let (whole, stats) = run(&points, Tagging::Chunked(2));
    assert!(stats.leaf_max >= 280_000 && stats.inner_node_max < 60_000, "{stats:?}");
    assert!(whole.triangles == expected);
    let (untagged, stats) = run(&points, Tagging::None);
    assert!(stats.untagged >= 280_000 && stats.root_points < 60_000, "{stats:?}");
    assert!(untagged.triangles == expected);
}

#[test]
fn coinciding_points_do_not_wait() {
    let count = 700_000;
    let heap: Vec<Point> =
        (0..count).map(|i| [f64::from(i % 4), f64::from(i % 4 % 3), f64::from(i)]).collect();
    let (mesh, stats) = run(&heap, Tagging::Chunked(1));
    assert_eq!((stats.points, stats.merged, stats.vertices), (count as u64, count as u64 - 4, 4));
    assert!(stats.held_max < 1 << 19, "{} points were held", stats.held_max);
    let mut first: Vec<Point> = mesh.vertices.clone();
    first.sort_by(|p, q| p.partial_cmp(q).expect("numbers"));
    assert_eq!(first, heap[..4]);
}

#[test]
fn limits_of_memory_are_kept_or_refused() {
    let mut random = Random::new(3);
    let points: Vec<Point> = (0..300_000).map(|_| [random.unit(), random.unit(), 0.0]).collect();
    let mut limited = |points: &[Point], tagging, megabytes: u64, threads| {
        let input = stream(points, Coordinates::F64, tagging, &mut random);
        let options = Options { threads, memory: Some(megabytes << 20), ..Options::default() };
        triangulate(&input, &options).map(|(_, stats)| stats)
    };
    for threads in [1, 3] {
        limited(&points, Tagging::Chunked(4), 60, threads).expect("enough memory");
        for tagging in [Tagging::Chunked(4), Tagging::None] {
            let failure = limited(&points, tagging, 14, threads).expect_err("too little memory");
            assert_eq!(failure.kind(), ErrorKind::Memory, "{failure}");
        }
    }
    let line: Vec<Point> = (0..300_000).map(|i| [f64::from(i), 3.0 * f64::from(i), 0.0]).collect();
    let failure = limited(&line, Tagging::Chunked(4), 40, 1).expect_err("a line has to be held");
    assert!(failure.kind() == ErrorKind::Memory && failure.to_string().contains("--memory"), "{failure}");
}
