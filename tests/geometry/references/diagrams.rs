use spmesh_reference::diagram4::{Point, diagram, dimension, sorted};

/// The corners of the unit cube form one cell with eight facets; a point at the centre divides it into eight
/// pyramids.
#[test]
fn diagrams_of_cubes_are_known() {
    let cube: Vec<Point> = (0..16).map(|i| [3, 2, 1, 0].map(|axis| 2 * (i >> axis & 1))).collect();
    let cells = diagram(&cube);
    assert_eq!(cells.len(), 9);
    assert_eq!(cells[0], (false, (0..16).collect(), (1..9).collect()));
    assert!(cells[1..].iter().all(|(_, vertices, neighbours)| vertices.len() == 8 && neighbours.len() == 7));
    let with_centre = diagram(&sorted([cube, vec![[1; 4]]].concat()));
    let finite = with_centre.iter().filter(|cell| !cell.0);
    assert_eq!((with_centre.len(), finite.map(|cell| cell.1.len()).collect()), (16, vec![9; 8]));
    assert_eq!(dimension(&[[0; 4], [1; 4], [2; 4], [0, 0, 0, 5]]), 2);
}
