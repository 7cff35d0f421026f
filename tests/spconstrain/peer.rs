//! Pipes with lines that cross at points only, against the crate `spade`.

use super::{audit, mesh, output};
use crate::programs::Folder;
use spmesh_reference::peer::Peer;
use spmesh_reference::segments::random_polylines;
use spmesh_reference::sets::{DEGENERATE_FAMILIES, Random, degenerate, uniform};

/// Steps of the grid for each unit: so lines pass no point closely, which would bend them.
const STEPS: i64 = 10_000;

/// How lines reach the mesh.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    /// Their vertices are points, too.
    Points,
    /// `spfinalize` adds their vertices.
    Finalize,
    /// `spconstrain` adds them.
    Constrain,
}

struct Scene {
    /// What `spfinalize` reads, with duplicates.
    points: Vec<[i64; 2]>,
    lines: Vec<Vec<[i64; 2]>>,
    way: Way,
}

impl Scene {
    fn random(random: &mut Random, mut points: Vec<[i64; 2]>, way: Way) -> Scene {
        let count = random.integer(1, 10) as usize;
        let lines = random_polylines(random, &points, count);
        if way == Way::Constrain {
            let corner = |i: i64| [[-4000, -4000], [4000, -4000], [4000, 4000], [-4000, 4000]][i as usize];
            points.extend((0..4).map(corner));
        }
        if way != Way::Points {
            points.retain(|point| !lines.iter().flatten().any(|vertex| vertex == point));
        }
        let copies = points.len() as i64 / 5;
        points.extend((0..copies).map(|i| points[3 * i as usize]).collect::<Vec<_>>());
        Scene { points, lines, way }
    }

    /// Points and lines in a new order, lines in any direction, as text in `points.txt`, `0.txt` and `1.txt`.
    fn write(&self, random: &mut Random, folder: &Folder) {
        let mut points: Vec<String> =
            self.points.iter().map(|[x, y]| format!("{x} {y} {}\n", random.integer(0, 99))).collect();
        random.shuffle(&mut points);
        folder.file("points.txt", points.concat());
        let mut lines = self.lines.clone();
        random.shuffle(&mut lines);
        // A file without lines is an error: both have a line of one vertex, at a point.
        let [x, y] = self.points[0];
        let mut texts = [(); 2].map(|()| format!("soft {x} {y}\n"));
        for mut line in lines {
            let text = &mut texts[random.integer(0, 1) as usize];
            if random.integer(0, 1) == 1 {
                line.reverse();
            }
            // Vertices without elevations are no points.
            let is_soft = self.way != Way::Finalize && random.integer(0, 1) == 1;
            *text += if is_soft { "soft" } else { "line" };
            for [x, y] in line {
                *text += &if is_soft { format!(" {x} {y}") } else { format!(" {x} {y} 50") };
            }
            *text += "\n";
        }
        folder.file("0.txt", &texts[0]);
        folder.file("1.txt", &texts[1]);
    }

    /// The mesh that a pipe makes, in any order and with any cells and threads.
    fn mesh(&self, random: &mut Random) -> super::Mesh {
        let folder = Folder::new();
        self.write(random, &folder);
        let files = ["0.txt", "1.txt"].map(|name| folder.path(name));
        let lines = ["--lines", &files[0], "--lines", &files[1]];
        let threads = ["--threads", ["1", "2", "3"][random.integer(0, 2) as usize]];
        let cells = [&["--level", "0"][..], &["--level", "3"], &["--cell-points", "20"], &["--preserve"]];
        let cells = cells[random.integer(0, 3) as usize];
        let points = folder.path("points.txt");
        let mut arguments = vec!["--scale", "0.0001,0.0001,0.0001", &points];
        arguments.extend(cells);
        if self.way == Way::Finalize {
            arguments.extend(lines);
        }
        let points = output("spfinalize", &arguments, &[]);
        let triangles = output("spdelaunay2d", &threads, &points);
        let constrained = output("spconstrain", &lines, &triangles);
        if random.integer(0, 3) == 0 {
            audit(&constrained);
        }
        mesh(&constrained)
    }

    /// Checks two runs, and returns whether the triangulation is the only one.
    fn is_unique(&self, random: &mut Random) -> bool {
        let found = self.mesh(random);
        let vertices = self.points.iter().chain(self.lines.iter().flatten());
        let stored = |place: &[i64; 2]| place.map(|value| STEPS * value);
        let vertices: Vec<[i64; 2]> = vertices.map(stored).collect();
        let parts = self.lines.iter().flat_map(|line| line.windows(2));
        let parts: Vec<[[i64; 2]; 2]> = parts.map(|part| [stored(&part[0]), stored(&part[1])]).collect();
        let peer = Peer::new(&vertices, &parts);
        let is_unique = peer.check(&found.triangles);
        if !found.triangles.is_empty() {
            assert!(found.constrained.iter().eq(&peer.links()), "sides on lines");
        }
        let again = self.mesh(random);
        assert_eq!(again.triangles, found.triangles);
        assert_eq!(again.constrained, found.constrained);
        is_unique
    }
}

const WAYS: [Way; 3] = [Way::Points, Way::Finalize, Way::Constrain];

#[test]
fn pipes_agree_with_spade_on_random_sets() {
    let mut unique = 0;
    for seed in 0..30 {
        let mut random = Random::new(seed + 60_000);
        let count = random.integer(20, 300) as usize;
        let points = uniform(&mut random, count, 900);
        let scene = Scene::random(&mut random, points, WAYS[seed as usize % 3]);
        unique += usize::from(scene.is_unique(&mut random));
    }
    assert!(unique > 20, "{unique} sets of 30 have one triangulation only");
}

#[test]
fn pipes_agree_with_spade_on_degenerate_sets() {
    // The circle of family 2 is too large for lines that are not bent.
    for family in (0..DEGENERATE_FAMILIES).filter(|&family| family != 2) {
        for way in WAYS {
            let seed = (10 * family + way as usize) as u64;
            let mut random = Random::new(seed + 70_000);
            let mut points = degenerate(&mut random, family, 150);
            points.retain(|point| point.iter().all(|value| value.abs() <= 1000));
            Scene::random(&mut random, points, way).is_unique(&mut random);
        }
    }
}
