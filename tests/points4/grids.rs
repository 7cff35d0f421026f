//! Grids without values.

use spmesh_base::error::ErrorKind;
use spmesh_formats::volumes::{From4, Request, Selection, Share, Spacing, read_points4};

use super::{all, assert_fails, with_condition};

fn chosen(lens: [u64; 4], share: Share, seed: u64) -> Request {
    let selection = Selection { share: Some(share), seed, ..Selection::default() };
    Request { selection, ..all(From4::Grid(lens)) }
}

#[test]
fn a_full_grid_has_every_site_once_x_fastest() {
    let points = read_points4(&all(From4::Grid([3, 2, 4, 5]))).unwrap();
    assert_eq!((points.points.len(), points.sites, points.values), (120, 120, None));
    assert_eq!(
        points.points[..4],
        [[0.0; 4], [1.0, 0.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]]
    );
    assert_eq!(points.points[119], [2.0, 1.0, 3.0, 4.0]);
    let mut sorted = points.points;
    sorted.sort_by(|a, b| a.partial_cmp(b).unwrap());
    sorted.dedup();
    assert_eq!(sorted.len(), 120);
}

#[test]
fn exactly_the_share_is_chosen_and_the_seed_decides() {
    let read = |share, seed| read_points4(&chosen([16; 4], share, seed)).unwrap();
    let points = read(Share::Part(0.4), 7);
    assert_eq!((points.points.len(), points.sites), (26214, 65536));
    assert_eq!(points, read(Share::Part(0.4), 7));
    assert_ne!(points.points, read(Share::Part(0.4), 8).points);
    assert_eq!(read(Share::Count(26214), 7).points, points.points);
    let number = |[x, y, z, t]: [f64; 4]| ((t * 16.0 + z) * 16.0 + y) * 16.0 + x;
    assert!(points.points.is_sorted_by(|a, b| number(*a) < number(*b)));
    // Each half of t has about as many points: six standard deviations are 480.
    let late = points.points.iter().filter(|point| point[3] >= 8.0).count();
    assert!(late.abs_diff(13107) < 480, "{late}");
    assert_eq!(read(Share::Part(1.0), 1).points.len(), 65536);
}

#[test]
fn conditions_and_shares_go_together() {
    let half = with_condition(From4::Grid([4; 4]), "x < 2 and (t == 0 or t == 3)");
    assert_eq!(read_points4(&half).unwrap().points.len(), 64);
    let mut request = half;
    request.selection.share = Some(Share::Part(0.5));
    let points = read_points4(&request).unwrap();
    assert_eq!((points.points.len(), points.sites), (32, 256));
    assert!(points.points.iter().all(|point| point[0] < 2.0 && (point[3] == 0.0 || point[3] == 3.0)));
}

#[test]
fn a_share_of_a_huge_grid_needs_no_more_than_itself() {
    // 2^40 sites: iterating over them would take hours, and storing them 35 terabytes.
    let points = read_points4(&chosen([1024; 4], Share::Count(1000), 3)).unwrap();
    assert_eq!((points.points.len(), points.sites), (1000, 1 << 40));
    assert!(points.points.iter().flatten().all(|coordinate| (0.0..1024.0).contains(coordinate)));
}

#[test]
fn absurd_sizes_are_refused_at_once() {
    let cases: [(Request, &str); 7] = [
        (all(From4::Grid([1 << 10; 4])), "more than 67108864"),
        (all(From4::Grid([200, 200, 200, 33])), "more than 67108864"),
        (all(From4::Grid([1 << 11; 4])), "more than 1099511627776"),
        (all(From4::Grid([u64::MAX; 4])), "more than 1099511627776"),
        (all(From4::Grid([3, 0, 3, 3])), "no sites"),
        (chosen([1024; 4], Share::Part(0.9), 1), "more than 67108864"),
        (chosen([2; 4], Share::Count(17), 1), "17 points are to be chosen, but there are 16"),
    ];
    for (request, part) in cases {
        assert_fails(read_points4(&request), ErrorKind::Usage, &["grid ", part]);
    }
}

#[test]
fn what_a_grid_has_not_cannot_be_asked_for() {
    let request = with_condition(From4::Grid([4; 4]), "x < 2 and value > 3");
    assert_fails(read_points4(&request), ErrorKind::Usage, &["no values", "x, y, z and t"]);
    let request = Request { spacing: Spacing::World, ..all(From4::Grid([4; 4])) };
    assert_fails(read_points4(&request), ErrorKind::Usage, &["--spacing"]);
}

#[test]
fn a_condition_that_nothing_fulfils_leaves_no_point() {
    let points = read_points4(&with_condition(From4::Grid([2; 4]), "x > 2")).unwrap();
    assert!(points.points.is_empty());
    assert_eq!(points.warnings, ["no point is left of 16: none fulfils what is asked for"]);
}
