//! Points of volumes, selected by their values and at random.

use spmesh_formats::volumes::{From4, Share, read_points4};

use super::{all, with_condition};
use crate::programs::Folder;

/// A raw volume of 8 x 8 x 8 x 4 values that grow with their number; every tenth is missing.
fn volume(folder: &Folder) -> From4 {
    let value = |number: u32| if number % 10 == 9 { f32::NAN } else { number as f32 / 2048.0 };
    let bytes: Vec<u8> = (0..2048).flat_map(|number| value(number).to_le_bytes()).collect();
    From4::Raw(folder.file("volume.raw", bytes), "8x8x8x4:f32le".parse().expect("a layout"))
}

#[test]
fn values_decide_and_go_with_their_points() {
    let folder = Folder::new();
    let points = read_points4(&with_condition(volume(&folder), "value >= 0.5 and x != 3")).unwrap();
    let values = points.values.unwrap();
    // Of the 1024 values from 0.5 on, 102 are missing. Of the 128 with x = 3, 25 are missing (number 1059 and
    // every 40th after it).
    assert_eq!((points.points.len(), values.len()), (1024 - 102 - (128 - 25), 819));
    for ([x, y, z, t], value) in points.points.iter().zip(values) {
        assert_eq!((x + 8.0 * (y + 8.0 * (z + 8.0 * t))) / 2048.0, value);
        assert!(value >= 0.5 && *x != 3.0);
    }
    assert_eq!(points.warnings, ["204 of 2048 points have no value (NaN) and are left out"]);
}

#[test]
fn a_share_is_one_of_the_points_that_fulfil_the_condition() {
    let folder = Folder::new();
    let mut request = with_condition(volume(&folder), "value >= 0.5");
    let whole = read_points4(&request).unwrap();
    assert_eq!(whole.points.len(), 922);
    request.selection.share = Some(Share::Part(0.25));
    request.selection.seed = 5;
    let part = read_points4(&request).unwrap();
    assert_eq!(part.points.len(), 231);
    assert_eq!(part, read_points4(&request).unwrap());
    assert!(part.points.iter().all(|point| whole.points.contains(point)));
    assert!(part.values.as_ref().unwrap().iter().all(|&value| value >= 0.5));
    request.selection.share = Some(Share::Count(922));
    assert_eq!(read_points4(&request).unwrap().points, whole.points);
    request.selection.share = Some(Share::Count(923));
    assert!(read_points4(&request).is_err());
}

#[test]
fn a_volume_and_a_grid_of_its_size_give_the_same_choice() {
    let folder = Folder::new();
    let raw = From4::Raw(folder.file("volume.raw", vec![0; 2048]), "8x8x8x4:u8".parse().unwrap());
    let [raw, grid] = [raw, From4::Grid([8, 8, 8, 4])].map(|from| {
        let mut request = all(from);
        request.selection.share = Some(Share::Part(0.1));
        request.selection.seed = 9;
        read_points4(&request).unwrap().points
    });
    assert_eq!(raw.len(), 205);
    assert_eq!(raw, grid);
}

#[test]
fn too_many_points_are_refused_before_one_is_kept() {
    // A file with a hole for all values but the first ones, which takes no room on the disk.
    let folder = Folder::new();
    let path = folder.file("volume.raw", b"");
    let large = std::fs::File::options().write(true).open(&path).unwrap();
    large.set_len(264_000_000).unwrap();
    let from = |kind: &str| From4::Raw(path.clone(), format!("1000x1000x66x4:{kind}").parse().unwrap());
    let refused = |request| {
        let error = read_points4(&request).expect_err("there are too many points");
        assert!(error.to_string().contains("--count"), "{error}");
        error.to_string()
    };
    assert!(refused(all(from("u8"))).contains("264000000 points, more than 67108864"));
    for (share, found) in
        [(Share::Part(0.5), "132000000 points"), (Share::Count(100_000_000), "100000000 points")]
    {
        let mut request = all(from("u8"));
        request.selection.share = Some(share);
        assert!(refused(request.clone()).contains(found));
        if let Share::Count(_) = share {
            request.selection.condition = Some("value == 0".parse().unwrap());
            assert!(refused(request).contains(found));
        }
    }
}
