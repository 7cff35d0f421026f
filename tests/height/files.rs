//! All bytes of files but the heights.

use super::{Parts, heights_in, mesh_of, scattered, u32_at, u64_at};
use crate::programs::{Folder, outcome, run, sample};
use crate::sources::las_file::{LasFile, geo_keys};

/// Asserts that records, header and other parts of `after` are those of `before`, but for a new field.
fn assert_kept(before: &Parts, after: &Parts, name: &str) {
    assert_eq!(after.record_len, before.record_len + 4, "{name}");
    assert_eq!(after.records().len(), before.records().len(), "{name}");
    for (old, new) in before.records().zip(after.records()) {
        assert_eq!(old, &new[..old.len()], "{name}");
    }
    assert_eq!(before.kept(), after.kept(), "{name}");
    // The lengths of records and what precedes them; where what follows the points starts.
    for (at, (old, new)) in before.header.iter().zip(&after.header).enumerate() {
        let may_change = matches!(at, 96..107 | 227..243);
        assert!(old == new || may_change, "{name}: byte {at} of the header");
    }
}

#[test]
fn all_other_bytes_stay() {
    let folder = Folder::new();
    for name in [
        "point10.las",
        "point10.laz",
        "1_4_w_evlr.las",
        "1_4_w_evlr.laz",
        "autzen.laz",
        "crop_duplicate.laz",
        "pointwise.laz",
        "lareunion.laz",
    ] {
        let bytes = std::fs::read(sample(name)).unwrap();
        let mesh = mesh_of(&bytes);
        let before = Parts::of(&bytes);
        for output in ["out.las", "out.laz"] {
            let written = heights_in(&folder, &mesh, &bytes, output, &[]);
            let after = Parts::of(&written);
            assert_eq!(after.header[104] & 0x80 != 0, output == "out.laz");
            assert_kept(&before, &after, name);
            if name.contains("evlr") {
                // The extended records, at the place that the header states.
                assert_eq!(u32_at(&after.header, 243), 1);
                let starts = [&before, &after].map(|parts| u64_at(&parts.header, 235) as usize);
                assert!(bytes[starts[0]..] == written[starts[1]..], "{name}");
                assert!(!after.tail.is_empty());
            }
            // Points of the mesh are on it: the median height is that of most points.
            let mut heights = after.heights();
            heights.retain(|height| *height != i32::MIN);
            assert!(heights.iter().filter(|height| **height == 0).count() * 2 > heights.len(), "{name}");
        }
    }
}

#[test]
fn the_field_is_described() {
    let folder = Folder::new();
    let bytes = std::fs::read(sample("crop_duplicate.laz")).unwrap();
    let mesh = mesh_of(&bytes);
    let written = heights_in(&folder, &mesh, &bytes, "out.laz", &["--name", "above"]);
    let (before, after) = (Parts::of(&bytes), Parts::of(&written));
    let descriptions = |parts: &Parts| {
        let found = parts.vlrs.iter().find(|(user, number, _)| (user.as_str(), *number) == ("LASF_Spec", 4));
        found.unwrap().2.clone()
    };
    let (old, new) = (descriptions(&before), descriptions(&after));
    assert_eq!(old, new[..old.len()]);
    let field = &new[old.len()..];
    assert_eq!((field.len(), field[2], field[3]), (192, 6, 9));
    assert!(field[4..].starts_with(b"above\0"));
    assert_eq!(u64_at(field, 40) as i64, i64::from(i32::MIN));
    assert_eq!(field[112..120], after.header[147..155], "the scale is that of z");
    // The other programs know it by its name.
    let path = folder.path("out.laz");
    let described = run("spfinalize", &["--attributes", "above", &path], &[]);
    assert!(described.status.success(), "{:?}", outcome(&described));
}

#[test]
fn bytes_without_a_meaning_are_described_before_the_field() {
    let folder = Folder::new();
    let points = scattered(50, 100, 1);
    let bytes = points.bytes();
    // Three bytes more in each record than the format has.
    let start = u32_at(&bytes, 96) as usize;
    let mut longer = bytes[..start].to_vec();
    longer[105] += 3;
    for record in bytes[start..].chunks_exact(28) {
        longer.extend_from_slice(record);
        longer.extend([7, 8, 9]);
    }
    let after = Parts::of(&heights_in(&folder, &mesh_of(&bytes), &longer, "out.las", &[]));
    assert_kept(&Parts::of(&longer), &after, "extra bytes");
    let [(_, _, described)] = &after.vlrs[..] else { panic!("one record: {:?}", after.vlrs) };
    assert_eq!((described.len(), described[2], described[3]), (2 * 192, 0, 3));
}

#[test]
fn heights_can_replace_z() {
    let folder = Folder::new();
    let ground = scattered(300, 1000, 4);
    let mut points = scattered(500, 1000, 5);
    points.offset = [0.0, 0.0, 100.0];
    points.records.iter_mut().for_each(|record| record.position[2] -= 5000);
    let (mesh, bytes) = (mesh_of(&ground.bytes()), points.bytes());
    let field = Parts::of(&heights_in(&folder, &mesh, &bytes, "f.las", &["--outside", "nearest"]));
    let after = Parts::of(&heights_in(&folder, &mesh, &bytes, "z.las", &["--replace-z"]));
    let before = Parts::of(&bytes);
    assert_eq!(after.record_len, before.record_len);
    for ((old, new), height) in before.records().zip(after.records()).zip(field.heights()) {
        assert_eq!((&old[..8], &old[12..]), (&new[..8], &new[12..]));
        assert_eq!(u32_at(new, 8) as i32, height);
    }
    let float = |at: usize| f64::from_le_bytes(*after.header[at..].first_chunk().unwrap());
    let heights = field.heights();
    assert_eq!(float(171), 0.0);
    assert_eq!(float(211), f64::from(*heights.iter().max().unwrap()) * 0.01);
    assert_eq!(float(219), f64::from(*heights.iter().min().unwrap()) * 0.01);
}

#[test]
fn copc_becomes_laz() {
    let folder = Folder::new();
    let path = sample("autzen.copc.laz");
    folder.file("ground.spm", mesh_of(&std::fs::read(&path).unwrap()));
    let (ground, out) = (folder.path("ground.spm"), folder.path("out"));
    let output = run("spheight", &["--ground", &ground, &path, "--out-dir", &out], &[]);
    let (code, message) = outcome(&output);
    assert!(code == Some(0) && message.contains("COPC is written as LAZ"), "{message}");
    let written = std::fs::read(folder.path("out/autzen.laz")).unwrap();
    let parts = Parts::of(&written);
    assert!(parts.vlrs.iter().all(|(user, ..)| user != "copc"));
    assert_eq!((u64_at(&parts.header, 235), u32_at(&parts.header, 243)), (0, 0));
    // The original, decompressed by a library: it reads the chunks of COPC by their table.
    let before = Parts::of(&std::fs::read(&path).unwrap());
    assert_eq!(before.records().len(), parts.records().len());
    for (old, new) in before.records().zip(parts.records()) {
        assert_eq!(old, &new[..old.len()]);
    }
}

/// Some files describe their extra bytes in several records, or describe more than there are.
#[test]
fn odd_descriptions_are_put_in_order() {
    let folder = Folder::new();
    let points = scattered(50, 100, 1);
    let (mesh, plain) = (mesh_of(&points.bytes()), points.bytes());
    let one = heights_in(&folder, &mesh, &plain, "one.las", &["--name", "one"]);
    let two = Parts::of(&heights_in(&folder, &mesh, &one, "two.las", &["--name", "two"]));
    let whole = &two.vlrs[0].2;
    assert_eq!(whole.len(), 2 * 192);
    // The same in two records.
    let vlr = |body: &[u8]| {
        let mut bytes = [0; 54];
        bytes[2..11].copy_from_slice(b"LASF_Spec");
        (bytes[18], bytes[20]) = (4, body.len() as u8);
        [&bytes, body].concat()
    };
    let mut divided = two.header.clone();
    let start = divided.len() + 2 * (54 + 192);
    divided[96..100].copy_from_slice(&(start as u32).to_le_bytes());
    divided[100] = 2;
    divided.extend([vlr(&whole[..192]), vlr(&whole[192..])].concat());
    divided.extend(&two.records);
    let three = Parts::of(&heights_in(&folder, &mesh, &divided, "out.las", &["--name", "three"]));
    assert_eq!((three.vlrs.len(), three.vlrs[0].2.len()), (1, 3 * 192));
    assert_eq!(three.vlrs[0].2[..2 * 192], whole[..]);
    let described = folder.file("divided.las", &divided);
    let named = run("spfinalize", &["--attributes", "one,two", described.to_str().unwrap()], &[]);
    assert!(named.status.success(), "{:?}", outcome(&named));
    // Descriptions of a file whose records have no extra bytes.
    let start = u32_at(&plain, 96) as usize;
    let mut without = plain[..227].to_vec();
    without[96..100].copy_from_slice(&(227 + 54 + 192u32).to_le_bytes());
    without[100] = 1;
    without.extend(vlr(&whole[..192]));
    without.extend(&plain[start..]);
    let four = Parts::of(&heights_in(&folder, &mesh, &without, "out.las", &[]));
    assert_eq!((four.record_len, four.vlrs[0].2.len()), (32, 192));
}

#[test]
fn many_files_keep_their_names() {
    let folder = Folder::new();
    let ground = mesh_of(&scattered(200, 1000, 1).bytes());
    let files = [("a/one.las", 2), ("b/two.LAZ", 3), ("b/three.las.gz", 4)];
    for (name, seed) in files {
        let file = scattered(100, 1000, seed);
        let bytes = if name.ends_with("LAZ") { file.compressed(30) } else { file.bytes() };
        let bytes = if name.ends_with(".gz") { crate::formats::gzip(&bytes) } else { bytes };
        folder.file(name, bytes);
    }
    let list: String = files.iter().map(|(name, _)| format!("{}\n", folder.path(name))).collect();
    folder.file("list", list);
    let (list, out) = (folder.path("list"), folder.path("new/out"));
    let output =
        run("spheight", &["-q", "--ground", "-", "--lof", &list, "--out-dir", &out, "--stats=json"], &ground);
    assert!(output.status.success(), "{:?}", outcome(&output));
    assert_eq!(folder.names("new/out"), ["one.las", "three.las", "two.LAZ"]);
    let stats: serde_json::Value = serde_json::from_slice(&output.stderr).unwrap();
    assert_eq!((&stats["files"], &stats["points"]), (&3.into(), &300.into()));
    let laz = run(
        "spheight",
        &["-q", "--ground", "-", &folder.path("a/one.las"), "--out-dir", &out, "--format", "laz"],
        &ground,
    );
    assert!(laz.status.success());
    assert_eq!(folder.names("new/out"), ["one.las", "one.laz", "three.las", "two.LAZ"]);
}

/// Files and meshes without points.
#[test]
fn nothing_is_a_result_too() {
    let folder = Folder::new();
    let empty = LasFile { projection: vec![geo_keys(2154)], ..LasFile::of(&[]) };
    let mesh = mesh_of(&scattered(20, 100, 1).bytes());
    for output in ["out.las", "out.laz"] {
        let after = Parts::of(&heights_in(&folder, &mesh, &empty.bytes(), output, &[]));
        assert_kept(&Parts::of(&empty.bytes()), &after, output);
    }
    let no_mesh = mesh_of(&LasFile::of(&[[1, 1, 1]]).bytes());
    let points = scattered(20, 100, 2).bytes();
    let after = Parts::of(&heights_in(&folder, &no_mesh, &points, "out.las", &[]));
    assert_eq!(after.heights(), vec![i32::MIN; 20]);
    folder.file("no.spm", no_mesh);
    let points = folder.write("points.las", points);
    let out = folder.path("out.las");
    let arguments = ["--ground", &folder.path("no.spm"), &points, "-o", &out, "--outside", "nearest"];
    let (code, message) = outcome(&run("spheight", &arguments, &[]));
    assert!(code == Some(0) && message.contains("they have no height, as it has no triangles"), "{message}");
    assert_eq!(Parts::of(&std::fs::read(out).unwrap()).heights(), vec![i32::MIN; 20]);
}

/// A header as short as those of LAS 1.2 has no fields of a later version that it names: there are records.
#[test]
fn short_headers_have_no_later_fields() {
    let folder = Folder::new();
    let points = LasFile { projection: vec![geo_keys(2154)], ..scattered(50, 100, 1) }.bytes();
    let mesh = mesh_of(&points);
    let mut named = points.clone();
    named[25] = 4;
    let after = Parts::of(&heights_in(&folder, &mesh, &named, "out.las", &[]));
    assert_kept(&Parts::of(&named), &after, "version 1.4");
    assert_eq!(mesh_of(&named), mesh);
}

/// Of two numbers of points, one is read, and both are written as that one.
#[test]
fn the_number_of_points_is_that_of_the_points() {
    let folder = Folder::new();
    let points = LasFile { format: 6, ..scattered(50, 100, 1) }.bytes();
    let mut both = points.clone();
    both[107] = 7;
    let after = Parts::of(&heights_in(&folder, &mesh_of(&points), &both, "out.las", &[]));
    assert_eq!((u32_at(&after.header, 107), u64_at(&after.header, 247)), (50, 50));
}

/// Heights that are taken for elevations are mostly below the ground.
#[test]
fn points_below_the_ground_are_noticed() {
    let folder = Folder::new();
    folder.file("ground.spm", mesh_of(&scattered(300, 1000, 4).bytes()));
    for (shift, is_noticed) in [(-5000, true), (5000, false)] {
        let mut points = scattered(500, 900, 5);
        points.records.iter_mut().for_each(|record| record.position[2] += shift);
        folder.file("points.las", points.bytes());
        let [ground, points, out] = ["ground.spm", "points.las", "out.las"].map(|name| folder.path(name));
        let found = run("spheight", &["--ground", &ground, &points, "-o", &out], &[]);
        let message = outcome(&found);
        assert_eq!(format!("{message:?}").contains("points are below the ground"), is_noticed, "{message:?}");
    }
}
