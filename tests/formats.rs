//! Every tool that reads several formats, with plain and compressed files: all use one table of formats and
//! one gzip layer.

use std::io::Write;

use spmesh_formats::detect::{Format, READERS, Reader, SPCONVERT, detect};

use crate::programs::{Folder, assert_outcome, cloud, outcome, run, sample};

/// gzip data with two members.
pub fn gzip(content: &[u8]) -> Vec<u8> {
    let member = |part: &[u8]| {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(part).expect("memory takes all");
        encoder.finish().expect("memory takes all")
    };
    let (first, second) = content.split_at(content.len() / 2);
    [member(first), member(second)].concat()
}

/// The output of a tool, which must succeed.
fn output(tool: &str, arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let output = run(tool, arguments, input);
    assert!(output.status.success(), "{tool} {arguments:?}: {:?}", outcome(&output));
    output.stdout
}

fn converted(input: &[u8], to: &str) -> Vec<u8> {
    output("spconvert", &["--to", to], input)
}

/// Arguments of each tool for an input of points.
fn arguments(tool: &str) -> &'static [&'static str] {
    match tool {
        "configgen" => &["--degree", "1"],
        "splinefit" => &["fit", "--tol", "1000"],
        "spconvert" => &["--to", "text"],
        "spcanopy" => &["--ground", "none"],
        "spground" => &["--out-dir", "."],
        "spreport" => &["--json", "-"],
        "spheight" => &["--ground", "none", "--out-dir", "."],
        _ => &[],
    }
}

/// Small files of all formats that hold points in space, with their names.
fn point_files() -> Vec<(&'static str, Vec<u8>)> {
    let text = cloud(300).into_bytes();
    let stream = output("spfinalize", &["-"], &text);
    let read = |name: &str| std::fs::read(sample(name)).expect("a sample");
    let mut files = vec![
        ("points.las", read("point10.las")),
        ("points.laz", read("point10.laz")),
        ("points.vtu", read("vtk_zlib.vtu")),
        ("points.vtk", read("vtk_fields.vtk")),
        ("points.xyz", text),
    ];
    for (name, to) in
        [("p.ply", "ply"), ("p.spa", "spa"), ("p.spb", "spb"), ("p.txt", "text"), ("p.spm", "spm")]
    {
        files.push((name, converted(&stream, to)));
    }
    let mesh = output("spdelaunay2d", &[], &stream);
    files.push(("mesh.obj", converted(&mesh, "obj")));
    files.push(("mesh.sma", converted(&mesh, "sma")));
    files
}

/// Runs a tool on a file, plain and compressed, by name and through a pipe, and texts also after a byte order
/// mark. All outputs must be equal.
fn assert_reads_compressed(tool: &str, arguments: &[&str], name: &str, content: &[u8]) {
    let folder = Folder::new();
    let compressed = gzip(content);
    let (plain_path, path) = (folder.write(name, content), folder.write(&format!("{name}.gz"), &compressed));
    let expected = output(tool, &[arguments, &[&plain_path]].concat(), &[]);
    assert!(!expected.is_empty(), "{tool} {name}");
    assert!(expected == output(tool, &[arguments, &[&path]].concat(), &[]), "{tool} {name}.gz");
    let [piped, of_plain] =
        [&compressed[..], content].map(|input| output(tool, &[arguments, &["-"]].concat(), input));
    assert!(piped == of_plain, "{tool} of {name}.gz");
    // Formats without a bounding box get one by reading a file twice, so that streams through a pipe have none.
    let has_box = tool != "spconvert"
        || !["ply", "spa", "spb", "obj", "sma", "smb"].iter().any(|it| name.ends_with(it));
    assert!(piped == expected || !has_box, "{tool} of {name}");
    if str::from_utf8(content).is_ok_and(|text| !text.contains('\0')) {
        let marked = folder.write(name, [b"\xef\xbb\xbf", content].concat());
        assert!(expected == output(tool, &[arguments, &[&marked]].concat(), &[]), "{tool} of marked {name}");
    }
}

#[test]
fn compressed_points_are_read_as_plain_ones() {
    for (name, content) in point_files() {
        assert_reads_compressed("spfinalize", &[], name, &content);
        // A file on stdin has no name to tell SPA from OBJ.
        assert_reads_compressed("spconvert", arguments("spconvert"), name, &content);
        let is_2d = ["p.txt", "p.spm"].contains(&name);
        if !is_2d {
            assert_reads_compressed("tess3", &[], name, &content);
        }
    }
    let text = cloud(60).into_bytes();
    for tool in ["configgen", "splinefit"] {
        assert_reads_compressed(tool, arguments(tool), "points.xyz", &text);
        assert_reads_compressed(tool, arguments(tool), "p.spm", &output("spfinalize", &["-"], &text));
    }
}

#[test]
fn compressed_meshes_and_streams_are_read_as_plain_ones() {
    let stream = output("spfinalize", &["-"], cloud(300).as_bytes());
    let mesh = output("spdelaunay2d", &[], &stream);
    for to in ["obj", "ply", "sma", "smb", "text", "spm"] {
        assert_reads_compressed("spconvert", &["--to", "text"], &format!("mesh.{to}"), &converted(&mesh, to));
    }
    assert_reads_compressed("spdelaunay2d", &[], "points.spm", &stream);
}

#[test]
fn compressed_structures_and_volumes_are_read_as_plain_ones() {
    for name in ["1aki.pdb", "1aki.cif"] {
        let content = std::fs::read(sample(name)).expect("a sample");
        assert_reads_compressed("tess3", &["--atoms", "ca"], name, &content);
    }
    let off = b"OFF\n5 0 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 2\n";
    assert_reads_compressed("tess3", &[], "points.off", off);
    assert_reads_compressed("tess3", &[], "atoms.xyz", b"4\n\nC 0 0 0\nC 1 0 0\nC 0 1 0\nC 0 0 1\n");
    let nrrd = b"NRRD0001\ntype: uchar\ndimension: 4\nsizes: 2 2 2 2\nencoding: raw\n\n0123456789abcdef";
    assert_reads_compressed("dd4", &[], "volume.nrrd", nrrd);
    let text: String =
        (0..40u64).map(|i| format!("{} {} {} {}\n", i, i * i % 7, i * 3 % 11, i * i % 13)).collect();
    assert_reads_compressed("dd4", &[], "points.txt", text.as_bytes());
}

#[test]
fn damaged_gzip_data_is_named_with_its_place() {
    let folder = Folder::new();
    let tools: [(&str, Vec<u8>); 6] = [
        ("spfinalize", cloud(5000).into_bytes()),
        ("configgen", cloud(60).into_bytes()),
        ("splinefit", cloud(60).into_bytes()),
        ("spconvert", cloud(5000).into_bytes()),
        ("tess3", std::fs::read(sample("1aki.pdb")).expect("a sample")),
        ("dd4", b"0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n".repeat(3)),
    ];
    for (tool, content) in tools {
        let whole = gzip(&content);
        let cut = &whole[..whole.len() - 9];
        let mut damaged = whole.clone();
        *damaged.iter_mut().nth_back(5).expect("a checksum") ^= 1;
        for (bytes, part) in [
            (cut, "ends early: it was cut off, or other bytes follow it, at byte "),
            (&damaged[..], "is damaged"),
        ] {
            let path = folder.write("input.gz", bytes);
            assert_outcome(tool, &[arguments(tool), &[&path]].concat(), &[], 3, part);
            assert_outcome(tool, &[arguments(tool), &["-"]].concat(), bytes, 3, "stdin");
        }
        let padded = folder.write("padded.gz", [&whole[..], &[0; 512]].concat());
        output(tool, &[arguments(tool), &[&padded]].concat(), &[]);
    }
}

#[test]
fn lists_of_files_are_read_from_files_and_pipes() {
    let folder = Folder::new();
    let paths = ["a.xyz", "b.xyz"].map(|name| folder.write(name, cloud(30)));
    let text = format!("\u{feff}{}\r\n\n# the other\n{}", paths[0], paths[1]);
    let lists = [folder.write("list", &text), folder.write("list.gz", gzip(text.as_bytes()))];
    let finalized = |arguments: &[&str]| output("spfinalize", arguments, text.as_bytes());
    let expected = finalized(&[&paths[0], &paths[1]]);
    for list in [&lists[0], &lists[1], "-"] {
        assert!(finalized(&["--lof", list]) == expected, "{list}");
        let out = folder.path(&format!("meshes-{}", list.len()));
        output("tess3", &["--lof", list, "--out-dir", &out], text.as_bytes());
        assert_eq!(std::fs::read_dir(&out).expect("the sweep").count(), 3, "{list}");
    }
    assert_outcome("spfinalize", &["--lof", &folder.write("none", "\n#\n")], &[], 2, "lists no files");
    assert_outcome("spfinalize", &["--lof", "-", "-"], text.as_bytes(), 2, "cannot both be stdin");
    assert_outcome("spdelaunay2d", &[&folder.path("")], &[], 2, "is a folder, expected a file");
}

/// The first bytes of a file of each format that is detected by its content.
fn start_of(format: Format) -> Vec<u8> {
    let mut nifti = vec![0; 400];
    nifti[..4].copy_from_slice(&348u32.to_le_bytes());
    nifti[344..348].copy_from_slice(b"n+1\0");
    let dicom = [&[0; 128][..], b"DICM\x02"].concat();
    let start: &[u8] = match format {
        Format::Las => b"LASF\0\0",
        Format::Stream => b"\x89SPM\r\n\x1a\n",
        Format::Twin => b"#spmesh 1\n",
        Format::Spa => b"# npoints 2\nv 1 2 3\n",
        Format::Spb => b"\x07\0\x06\0\0\0\0",
        Format::Sma => b"# nverts 3\nv 1 2 3\n",
        Format::Smb => b"\0\0\0\0\0\0\0\0\x03\0\0\0",
        Format::Ply => b"ply\nformat ascii 1.0\n",
        Format::Obj => b"o thing\nv 1 2 3\n",
        Format::VertexLines => b"v 1 2 3\nv 2 3 4\nv 3 4 5\nf 1 2 3\n",
        Format::Off => b"OFF\n3 1 0\n",
        Format::VtkLegacy => b"# vtk DataFile Version 3.0\n",
        Format::VtkXml => b"<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">",
        Format::Npy => b"\x93NUMPY\x01\0",
        Format::Pdb => b"HEADER    A MOLECULE\nATOM      1  N   LYS A   1\n",
        Format::Pqr => b"ATOM 1 N LYS 1 0.1 0.2 0.3 -0.4 1.85\n",
        Format::Mmtf => b"\xde\0\x27\xabmmtfVersion\xa31.0",
        Format::Gro => b"water\n1\n    1SOL     OW    1   0.560   0.049   0.540\n",
        Format::Xtc => b"\0\0\x07\xcb\0\0\0\x02",
        Format::Trr => b"\0\0\x07\xc9\0\0\0\x0d\0\0\0\x0cGMX_trn_file",
        Format::Dcd => b"\x54\0\0\0CORD\x01\0\0\0",
        Format::Lammps => b"water\n\n2 atoms\n\n0 10 xlo xhi\n",
        Format::Mol2 => b"@<TRIPOS>MOLECULE\nwater\n 1 0\n",
        Format::Sdf => b"water\n\n\n  1  0  0  0  0  0            999 V2000\n",
        Format::Mmcif => b"data_1AKI\n#\nloop_\n",
        Format::Xyz => b"2\nhydrogen\nH 0 0 0\nH 0 0 1\n",
        Format::Nrrd => b"NRRD0004\n",
        Format::Nifti => &nifti,
        Format::Text => b"# cloud\n1 2 3\n",
        Format::OtherText => b"no points at all\n",
        Format::Gzip => b"\x1f\x8b\x08",
        Format::Zstd => b"\x28\xb5\x2f\xfd",
        Format::Zip => b"PK\x03\x04",
        Format::Bzip2 => b"BZh91AY",
        Format::Xz => b"\xfd7zXZ\0",
        Format::Compress => b"\x1f\x9d\x90",
        Format::BinaryCif => b"\x83\xa7version\xa50.3.0",
        Format::Utf16 => b"\xff\xfe1\0",
        Format::Pcd => b"# .PCD v0.7\n",
        Format::E57 => b"ASTM-E57\x01\0\0\0",
        Format::Bpf => b"BPF!0003",
        Format::Rdbx => b"RIEGL LMS RDB 2 POINTCLOUD FILE",
        Format::Compound => b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
        Format::Ptx => {
            b"2\r\n1\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n0 0 1\r\n1 0 0 0\r\n0 1 0 0\r\n0 0 1 0\r\n0 0 0 1\r\n1 2 3 0.5\r\n"
        }
        Format::Stl => b"solid part\n  facet normal 0 0 1\n    outer loop\n",
        Format::Gltf => b"glTF\x02\0\0\0",
        Format::Gmsh => b"$MeshFormat\n4.1 0 8\n",
        Format::Fbx => b"Kaydara FBX Binary  \0",
        Format::Dwg => b"AC1032\0",
        Format::DxfDrawing => b"  0\r\nSECTION\r\n  2\r\nHEADER\r\n",
        Format::Shapefile => b"\0\0\x27\x0a\0\0\0\0",
        Format::Sqlite => b"SQLite format 3\0",
        Format::FlatGeobuf => b"fgb\x03fgb\0",
        Format::Json => b"{ \"type\": \"FeatureCollection\", \"features\": [\n1 2 3\n",
        Format::Parquet => b"PAR1\x15",
        Format::AsciiGrid => b"NCOLS 3\nNROWS 2\nXLLCORNER 0\n1 2 3\n",
        Format::SurferGrid => b"DSAA\n2 2\n0 1\n",
        Format::MetaImage => b"ObjectType = Image\nNDims = 3\n",
        Format::Dicom => &dicom,
        Format::Picture => b"\x89PNG\r\n",
        Format::Pdf => b"%PDF-1.4\n",
        Format::Hdf5 => b"\x89HDF\r\n",
        Format::Netcdf => b"CDF\x01",
        Format::Medit => b"MeshVersionFormatted 2\n",
        Format::Inrimage => b"#INRIMAGE-4#{\n",
        Format::Tiff => b"II*\0",
        Format::Xml => b"<!DOCTYPE html>\n",
        Format::Binary => b"abc\0",
        Format::Dxf | Format::LandXml | Format::GeoJson => unreachable!("is written only"),
    };
    start.to_vec()
}

#[test]
fn each_format_is_told_from_all_others() {
    for format in Format::all() {
        assert_eq!(detect(&start_of(format)).unwrap(), format);
        let marked = [b"\xef\xbb\xbf", &start_of(format)[..]].concat();
        assert_eq!(detect(&marked).unwrap(), format);
    }
    assert!(detect(b"").unwrap_err().to_string().contains("empty"));
}

#[test]
fn names_of_columns_are_no_molecules() {
    let rows = "1 2 3\n4 5 6\n7 8 1\n";
    for names in ["data_x data_y data_z", "loop_ y z", "MODEL x y", "AUTHOR me", "ATOM x y", "HETATM y z"] {
        assert_eq!(detect(format!("{names}\n{rows}").as_bytes()).unwrap(), Format::Text, "{names}");
        let (names, rows) = (names.replace(' ', ","), rows.replace(' ', ","));
        assert_eq!(detect(format!("{names}\n{rows}").as_bytes()).unwrap(), Format::Text, "{names}");
    }
    for text in
        ["MODEL 1", "MODEL        1", "REMARK 350", "END\nCRYST1   59.062", "ATOM      1  N   LYS A   1"]
    {
        assert_eq!(detect(text.as_bytes()).unwrap(), Format::Pdb, "{text}");
    }
    for text in ["data_1AKI", "DATA_1AKI  # a comment", "#\nloop_\n_atom_site.id"] {
        assert_eq!(detect(text.as_bytes()).unwrap(), Format::Mmcif, "{text}");
    }
}

#[test]
fn formats_that_a_tool_does_not_read_are_named_with_those_it_reads() {
    let folder = Folder::new();
    for Reader { tool, .. } in READERS.iter().filter(|reader| reader.tool != "spinfo") {
        let reader = READERS.iter().find(|reader| reader.tool == *tool).expect("a reader");
        for format in Format::all().filter(|&format| !reader.reads(format)) {
            let bytes = start_of(format);
            // To the tools, the outer layer of compression is not a format.
            let is_outer = matches!(format, Format::Gzip | Format::Zstd);
            let bytes = if is_outer { gzip(&bytes) } else { bytes };
            let path = folder.write("input", bytes);
            let found = if format == Format::Binary {
                "zero byte at byte 3".to_string()
            } else {
                format!("input: this is {}; {tool} reads ", format.name())
            };
            let by_name = [Format::Binary, Format::VertexLines, Format::OtherText].contains(&format);
            let (code, part) = match *tool {
                "spconvert" if by_name => (2, "give it with --from"),
                _ => (3, &found[..]),
            };
            assert_outcome(tool, &[arguments(tool), &[&path]].concat(), &[], code, part);
            if *tool == "dd4" && [Format::Pdb, Format::Spa, Format::Off].contains(&format) {
                assert_outcome(tool, &[&path], &[], code, "lines of x y z t");
            }
        }
    }
}

#[test]
fn points_of_any_source_are_converted() {
    let folder = Folder::new();
    let path = sample("point10.las");
    let twin = String::from_utf8(output("spconvert", &["--to", "text", &path], &[])).expect("text");
    let through_pipe = output("spconvert", &["--to", "text"], &std::fs::read(&path).expect("a sample"));
    assert_eq!(twin.as_bytes(), through_pipe);
    // A stream without tags has the points in the order and the coordinates of the file.
    let preserved = output("spfinalize", &["--preserve", &path], &[]);
    let preserved = String::from_utf8(converted(&preserved, "text")).expect("text");
    let points = |text: &str| -> Vec<String> {
        text.lines().filter(|line| line.starts_with("v ")).map(str::to_string).collect()
    };
    assert!(points(&twin) == points(&preserved) && !points(&twin).is_empty(), "{twin}");
    let solid = folder.write("points.csv", "x,y,z\n1,2,3\n4,5,6.5\n");
    let twin =
        String::from_utf8(output("spconvert", &["--to", "text", "--dims", "3", &solid], &[])).expect("text");
    assert!(twin.contains("v 1 2 3\nv 4 5 6.5\n"), "{twin}");
    assert_outcome("spconvert", &["--to", "points", &solid], &[], 2, "possible values");
    assert!(SPCONVERT.reads(Format::Las));
}
