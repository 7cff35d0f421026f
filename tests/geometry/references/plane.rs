use spmesh_reference::incremental::{area, filtered_incircle, perturbed_incircle};
use spmesh_reference::sets::Random;

#[test]
fn floating_point_decides_as_integers_do() {
    let mut random = Random::new(12);
    let (mut decided, mut undecided) = (0, 0);
    for round in 0..40_000 {
        let most = [2, 50, 1 << 15, (1 << 30) - 1][round % 4];
        let points = [0; 4].map(|_| [0; 2].map(|_: i32| random.integer(-most, most)));
        if area(points[0], points[1], points[2]) <= 0 || points[..3].contains(&points[3]) {
            continue;
        }
        match filtered_incircle(points) {
            Some(is_inside) => {
                assert_eq!(is_inside, perturbed_incircle(points), "{points:?}");
                decided += 1;
            }
            None => undecided += 1,
        }
    }
    assert!(decided > 10 * undecided && undecided > 100, "{decided}, {undecided}");
}
