//! Volumes whose grid is oblique in the world. What is expected was computed with nibabel.

use super::{as_text, diagram, proof};
use crate::programs::{Folder, outcome, run, sample};

/// The affine maps of the two samples as nibabel gives them: by `sform`, and by `qform`.
const SAMPLES: [(&str, [[f64; 4]; 3]); 2] = [
    (
        "oblique_sform.nii",
        [
            [-1.872586727142334, -0.7240737080574036, -0.5960080027580261, 90.5],
            [-0.5501917004585266, 2.3910627365112305, -0.2935301959514618, -126.0],
            [-0.43670132756233215, 0.09239253401756287, 2.925510883331299, -72.25],
        ],
    ),
    (
        "oblique_qform.nii",
        [
            [-1.872586511705653, -0.724073747260951, -0.59600942247602, 90.5],
            [-0.550191671314924, 2.3910627059401155, -0.29353038522964237, -126.0],
            [-0.4367022795838655, 0.09239234161886187, 2.925510670167986, -72.25],
        ],
    ),
];

/// Sizes of the samples in space.
const LENS: [usize; 3] = [4, 3, 3];

/// Volume of a voxel.
const VOXEL: f64 = 2.0 * 2.5 * 3.0;

type Place = [f64; 3];

fn to_world(affine: &[[f64; 4]; 3], voxel: Place) -> Place {
    affine.map(|[x, y, z, w]| x * voxel[0] + y * voxel[1] + z * voxel[2] + w)
}

fn minus(a: Place, b: Place) -> Place {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn cross(a: Place, b: Place) -> Place {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: Place, b: Place) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Vertices and elements of `corners` corners in a file of Medit.
fn medit(text: &str, section: &str, corners: usize) -> (Vec<Place>, Vec<Vec<usize>>) {
    let rows = |name: &str| -> Vec<Vec<f64>> {
        let mut lines = text.lines().skip_while(|line| *line != name).skip(1);
        let count = lines.next().unwrap().parse().unwrap();
        let numbers = |line: &str| line.split_whitespace().map(|word| word.parse().unwrap()).collect();
        lines.take(count).map(numbers).collect()
    };
    let vertices = rows("Vertices").iter().map(|row| [row[0], row[1], row[2]]).collect();
    let elements = rows(section);
    let elements = elements.iter().map(|row| row[..corners].iter().map(|&id| id as usize - 1).collect());
    (vertices, elements.collect())
}

fn world(name: &str, flags: &[&str]) -> Vec<u8> {
    diagram(&[&[&sample(name), "--spacing", "world", "-q"], flags].concat(), &[])
}

#[test]
fn slices_lie_where_the_affine_map_puts_them() {
    for (name, affine) in SAMPLES {
        let folder = Folder::new();
        let path = folder.path("slice.mesh");
        world(name, &["--slice", "1.5", "-o", &path]);
        let text = std::fs::read_to_string(&path).unwrap();
        let (vertices, tetrahedra) = medit(&text, "Tetrahedra", 4);
        for number in 0..LENS.iter().product() {
            let voxel = [number % 4, number / 4 % 3, number / 12].map(|index| index as f64);
            let place = to_world(&affine, voxel);
            let distance = |vertex: &Place| dot(minus(*vertex, place), minus(*vertex, place));
            let nearest = vertices.iter().map(distance).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-10, "{name}: voxel {voxel:?} is {} away", nearest.sqrt());
        }
        let volume = |corners: &Vec<usize>| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| vertices[corners[i]]);
            dot(cross(minus(b, a), minus(c, a)), minus(d, a)) / 6.0
        };
        let volumes: Vec<f64> = tetrahedra.iter().map(volume).collect();
        assert!(volumes.iter().all(|&volume| volume > 0.0), "{name}");
        assert!((volumes.iter().sum::<f64>() - 12.0 * VOXEL).abs() < 1e-4, "{name}");
    }
}

#[test]
fn surfaces_face_lesser_values_in_the_world() {
    for (name, affine) in SAMPLES {
        let folder = Folder::new();
        let path = folder.path("surface.mesh");
        world(name, &["--slice", "1.5", "--isosurface", "17.3", "-o", &path]);
        let (vertices, triangles) = medit(&std::fs::read_to_string(&path).unwrap(), "Triangles", 3);
        assert!(triangles.len() > 20, "{}", triangles.len());
        // The values of the samples are 7 i + 3 j^2 - 5 k + 11 t: between sites, j counts 3 to 9 times.
        let sizes = [2.0, 2.5, 3.0];
        let columns = [0, 1, 2].map(|at| [0, 1, 2].map(|row| affine[row][at] / sizes[at]));
        for corners in triangles {
            let [a, b, c] = [0, 1, 2].map(|i| vertices[corners[i]]);
            let normal = cross(minus(b, a), minus(c, a));
            for slope in [3.0, 9.0] {
                let along = [7.0 / sizes[0], slope / sizes[1], -5.0 / sizes[2]];
                let gradient = [0, 1, 2].map(|i| (0..3).map(|at| along[at] * columns[at][i]).sum::<f64>());
                assert!(dot(normal, gradient) < 0.0, "{name}: {a:?} {b:?} {c:?}");
            }
        }
    }
}

#[test]
fn sites_and_conditions_are_in_the_world() {
    for (name, affine) in SAMPLES {
        for (voxel, time, expected) in
            [([1.0, 1.0, 1.0], 1.5, 16.0), ([2.0, 1.0, 1.0], 3.0, 34.0), ([1.5, 1.0, 1.0], 0.75, 14.0)]
        {
            let [x, y, z] = to_world(&affine, voxel);
            let text = String::from_utf8(world(name, &["--at", &format!("{x},{y},{z},{time}")])).unwrap();
            let found: f64 = text.trim_end().rsplit('\t').next().unwrap().parse().unwrap();
            assert!((found - expected).abs() < 1e-4, "{name} {voxel:?}: {text}");
        }
        let stream = world(name, &["--where", "x > 86 and z < -68"]);
        assert_eq!(proof(&stream)["vertices"], 45);
    }
}

#[test]
fn streams_hold_distances_along_the_grid_and_say_so() {
    for (name, _) in SAMPLES {
        let output = run("dd4", &[&sample(name), "--spacing", "world"], &[]);
        let (code, message) = outcome(&output);
        assert_eq!(code, Some(0), "{message}");
        assert!(
            message.contains("oblique in the world: x, y and z in the stream are distances"),
            "{message}"
        );
        assert!(!message.contains("rounded"), "{message}");
        // Each voxel is a cell, as in grid indices.
        assert_eq!(proof(&output.stdout)["cells"], 3 * 2 * 2 * 2);
        let text = String::from_utf8(as_text(&output.stdout)).unwrap();
        assert!(text.lines().any(|line| line == "v4 6 5 6 3 45"), "{text}");
        let (code, message) =
            outcome(&run("dd4", &[&sample(name), "--spacing", "world", "--quantum", "1"], &[]));
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains("--quantum or --spacing world"), "{message}");
    }
}
