//! No output replaces what a run reads, whichever flag names it, and whichever code opens it.

use std::fs;
use std::path::Path;

use crate::programs::{Folder, cloud, outcome, run, sample};

/// Flags that name outputs, as programs may have them.
const OUTPUTS: [&str; 9] = [
    "--output",
    "--report",
    "--plan",
    "--levels",
    "--skip-bad",
    "--residuals",
    "--rejected",
    "--summary",
    "--json",
];

/// Flags that take any text, and name no file.
const TEXTS: [&str; 5] = ["--comment", "--attributes", "--altloc", "--assembly", "--chain"];

/// A system of coordinates, as `.prj` files have it.
const SYSTEM: &str = r#"PROJCS["Local",GEOGCS["GRS 80",DATUM["Unknown",SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["central_meridian",9],UNIT["metre",1]]"#;

/// What a file must hold to be read by a flag. Other flags are refused before they read anything.
fn content(flag: &str) -> &'static str {
    match flag {
        "--crs" => SYSTEM,
        "--radii" => "* * 1.7\n",
        _ => "0 0 0\n9 0 1\n0 9 2\n9 9 4\n",
    }
}

/// Flags with values that the help of a command lists.
fn flags(command: &[&str]) -> Vec<String> {
    let help = run(command[0], &[&command[1..], &["--help"]].concat(), &[]);
    let help = String::from_utf8(help.stdout).unwrap();
    let flag = |line: &str| {
        let line = line.trim_start();
        let (names, _) =
            line.strip_prefix("-").and(line.split_once(" <").or_else(|| line.split_once("[=")))?;
        names.split(", ").find(|name| name.starts_with("--")).map(str::to_string)
    };
    help.lines().filter_map(flag).collect()
}

/// A command of every program, and arguments with which it runs in a folder that has the files.
const COMMANDS: [(&[&str], &[&str]); 27] = [
    (&["spfinalize"], &["points.txt"]),
    (&["spdelaunay2d"], &["points.spm"]),
    (&["spdelaunay3d"], &["points3.spm"]),
    (&["spdem"], &["--columns", "9", "mesh.spm"]),
    (&["spdem"], &["--contours", "50", "mesh.spm"]),
    (&["spconstrain"], &["--kill", "90000", "mesh.spm"]),
    (&["spheight"], &["--ground", "mesh.spm", "tile.las"]),
    (&["spcanopy"], &["--ground", "mesh.spm", "--step", "50", "tile.las"]),
    (&["spground"], &["tile.las"]),
    (&["spreport"], &["tile.las"]),
    (&["spdiff"], &["mesh.spm", "--level", "1"]),
    (&["spsimplify"], &["--tolerance", "9", "mesh.spm"]),
    (&["sptiles"], &["--tolerance", "9", "--out-dir", "tiles", "mesh.spm"]),
    (&["spview"], &["mesh.spm"]),
    (&["spinfo"], &["mesh.spm"]),
    (&["spconvert"], &["--to", "text", "mesh.spm"]),
    (&["spnode", "list"], &["plan.json"]),
    (&["spnode", "run"], &["plan.json", "0", "-d", "parts"]),
    (&["spnode", "collect"], &["plan.json", "-d", "parts"]),
    (&["tess3"], &["--sasa", "atoms.pdb"]),
    (&["tess3"], &["--out-dir", "out", "atoms.pdb"]),
    (&["dd4"], &["points4.txt"]),
    (&["configgen"], &["points.txt"]),
    (&["splinefit", "fit"], &["--robust", "huber", "points.txt"]),
    (&["splinefit", "eval"], &["--columns", "9", "spline.spm"]),
    (&["splinefit", "mesh"], &["spline.spm"]),
    (&["splinefit", "info"], &["spline.spm"]),
];

/// Makes the files of [`COMMANDS`].
fn prepare(folder: &Folder) {
    folder.write("points.txt", cloud(200));
    folder.write("points4.txt", "0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n3 4 5 6\n");
    for (from, to) in [("1aki.pdb", "atoms.pdb"), ("point10.las", "tile.las")] {
        fs::copy(sample(from), folder.path(to)).unwrap();
    }
    let [points, points3, mesh, spline, text, tile, plan] =
        ["points.spm", "points3.spm", "mesh.spm", "spline.spm", "points.txt", "tile.las", "plan.json"]
            .map(|name| folder.path(name));
    for arguments in [
        &["spfinalize", &text, "-o", &points][..],
        &["spfinalize", "--octree", &text, "-o", &points3],
        &["spdelaunay2d", &points, "-o", &mesh],
        &["splinefit", "fit", "--step", "20000", &text, "-o", &spline],
        &["spfinalize", "--plan", &plan, &tile],
        &["spnode", "run", &plan, "0", "-d", &folder.path("parts")],
    ] {
        let output = run(arguments[0], &arguments[1..], &[]);
        assert!(output.status.success(), "{arguments:?}: {:?}", outcome(&output));
    }
}

/// Runs a command in a folder. Returns its exit code and message.
fn run_in(folder: &Path, command: &[&str], arguments: &[&str]) -> (Option<i32>, String) {
    let mut tool = crate::programs::tool(command[0]);
    outcome(&tool.args(&command[1..]).args(arguments).current_dir(folder).output().unwrap())
}

#[test]
fn no_program_is_forgotten() {
    let programs = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("bin")).unwrap();
    for file in programs.map(|entry| entry.unwrap().path()) {
        let name = file.file_stem().unwrap().to_str().unwrap();
        assert!(COMMANDS.iter().any(|(command, _)| command[0] == name), "{name}");
    }
}

/// The help lists the flags: a new one cannot be forgotten.
#[test]
fn no_flag_names_a_file_that_an_output_may_replace() {
    let folder = Folder::new();
    prepare(&folder);
    let (mut pairs, mut refused, mut lost) = (0, 0, Vec::new());
    for (command, arguments) in COMMANDS {
        let flags = flags(command);
        let (outputs, others): (Vec<_>, Vec<_>) =
            flags.iter().partition(|flag| OUTPUTS.contains(&flag.as_str()));
        for (flag, output) in others.iter().flat_map(|flag| outputs.iter().map(move |output| (flag, output)))
        {
            let before = content(flag);
            folder.write("given", before);
            let both = [flag.as_str(), "given", output.as_str(), "given"];
            let (code, message) = run_in(folder.root(), command, &[arguments, &both].concat());
            let is_same = fs::read_to_string(folder.path("given")).is_ok_and(|after| after == before);
            if !is_same && !TEXTS.contains(&flag.as_str()) {
                lost.push(format!("{command:?} {both:?}: {code:?} {message}"));
            }
            pairs += 1;
            refused += usize::from(message.contains("would replace the input"));
        }
    }
    println!("{} commands, {pairs} pairs of flags, {refused} refused, {} lost", COMMANDS.len(), lost.len());
    assert!(lost.is_empty(), "{lost:#?}");
    // The others name no file, or do not go with what the command does.
    assert!(pairs > 300 && refused > 60, "{refused} of {pairs}");
}

/// Asserts that a command would replace a file, and leaves it alone.
fn assert_kept(folder: &Folder, command: &str, kept: &str) {
    let before = fs::read(folder.path(kept)).unwrap();
    let words: Vec<&str> = command.split_whitespace().collect();
    let (code, message) = run_in(folder.root(), &words[..1], &words[1..]);
    let is_same = fs::read(folder.path(kept)).is_ok_and(|after| after == before);
    assert!(is_same && code == Some(2), "{command}: {code:?} {message}");
    assert!(message.contains("would replace the input"), "{command}: {message}");
}

#[test]
fn files_beside_inputs_are_kept() {
    let folder = Folder::new();
    folder.write("points.txt", "0 0 1\n30 0 2\n0 30 3\n30 30 4\n");
    for name in ["lines.geojson", "lines.shp", "lines.prj", "water.shp", "water.dbf"] {
        fs::copy(sample(name), folder.path(name)).unwrap();
    }
    let header = "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 2 2 2 2\nencoding: raw\ndata file: v.raw\n";
    folder.write("v.nhdr", header);
    folder.write("v.raw", [1; 16]);
    folder.write("r", content("--radii"));
    folder.write("atoms.pdb", fs::read(sample("1aki.pdb")).unwrap());
    folder.write("list", "points\n");
    fs::copy(folder.path("points.txt"), folder.path("points")).unwrap();
    for (command, kept) in [
        ("spfinalize points.txt --lines lines.shp --report lines.prj", "lines.prj"),
        ("spfinalize points.txt --flatten water.shp --report water.dbf", "water.dbf"),
        ("dd4 v.nhdr -o v.raw", "v.raw"),
        ("tess3 --sasa --out-dir out --radii r atoms.pdb --summary r", "r"),
        ("spfinalize --lof list --lines lines.geojson --report points", "points"),
    ] {
        assert_kept(&folder, command, kept);
    }
}

#[test]
fn files_of_plans_and_parts_are_kept() {
    let folder = Folder::new();
    let tile = fs::read(sample("point10.las")).unwrap();
    folder.write("tile.las", &tile);
    let polygon = r#"{"type":"Polygon","coordinates":[[[-1e9,-1e9],[1e9,-1e9],[1e9,1e9],[-1e9,-1e9]]]}"#;
    folder.write("area.geojson", polygon);
    let succeed = |command: &str| {
        let words: Vec<&str> = command.split_whitespace().collect();
        let (code, message) = run_in(folder.root(), &words[..1], &words[1..]);
        assert_eq!(code, Some(0), "{command}: {message}");
    };
    succeed("spfinalize --plan plan.json --clip area.geojson tile.las");
    let listed = run("spnode", &["list", &folder.path("plan.json")], &[]).stdout;
    let name = String::from_utf8(listed).unwrap().trim_end().rsplit('\t').next().unwrap().to_string();
    let files = ["spm", "json"].map(|ending| format!("{}/{name}.{ending}", &name[..2]));
    // A tile, and a plan, under the names of what the node writes.
    for (number, (file, input)) in files.iter().zip(["tile.las", "plan.json"]).enumerate() {
        let place = format!("parts{number}/{file}");
        folder.write(&place, "");
        fs::remove_file(folder.path(&place)).unwrap();
        fs::hard_link(folder.path(input), folder.path(&place)).unwrap();
        assert_kept(&folder, &format!("spnode run plan.json 0 -d parts{number}"), &place);
    }
    succeed("spnode run plan.json 0 -d other");
    for kept in ["area.geojson", "tile.las", "plan.json"] {
        let command = format!("spnode collect plan.json -d other -o {kept}");
        let before = fs::read(folder.path(kept)).unwrap();
        let words: Vec<&str> = command.split_whitespace().collect();
        let (code, message) = run_in(folder.root(), &words[..1], &words[1..]);
        assert_eq!(code, Some(2), "{command}: {message}");
        assert!(fs::read(folder.path(kept)).unwrap() == before, "{command}: {message}");
    }
    succeed("spnode collect plan.json -d other -o mesh.json");
    succeed("spnode run plan.json 0 -d other --force");
    let part = format!("other/{}", files[0]);
    for command in ["spconvert mesh.json", "spview mesh.json --format svg", "spconstrain --kill 9 mesh.json"]
    {
        assert_kept(&folder, &format!("{command} -o {part}"), &part);
    }
}
