//! Standard streams, and outputs whose place is wrong: each tool says so before it works.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::process::{Command, Output, Stdio};

use crate::programs::{Folder, cloud, mesh_of_cloud, outcome, run, tool};

/// A run that succeeds: the tool, its arguments but for the output, and the input.
struct Run {
    tool: &'static str,
    arguments: Vec<String>,
    /// The file among the arguments that is read.
    input: String,
    /// Whether it has `-o`.
    has_output: bool,
}

/// A run of each tool and subcommand on small files in `folder`.
fn runs(folder: &Folder) -> Vec<Run> {
    let text = folder.write("points.txt", cloud(200));
    let text4 = folder.write("points4.txt", "0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n3 4 5 6\n");
    let made = |name: &str, tool: &str, arguments: &[&str]| {
        let output = run(tool, arguments, &[]);
        assert!(output.status.success(), "{:?}", outcome(&output));
        folder.write(name, output.stdout)
    };
    let points = made("points.spm", "spfinalize", &[&text]);
    let points3 = made("points3.spm", "spfinalize", &["--octree", &text]);
    let mesh = made("mesh.spm", "spdelaunay2d", &[&points]);
    let spline = made("spline.spm", "splinefit", &["fit", "--step", "20000", &text]);
    let one = |tool, before: &[&str], input: &str, has_output| {
        let arguments = before.iter().chain([&input]).map(|word| word.to_string()).collect();
        Run { tool, arguments, input: input.to_string(), has_output }
    };
    vec![
        one("spfinalize", &[], &text, true),
        one("spdelaunay2d", &[], &points, true),
        one("spdelaunay2d", &["--partial", "--region", "0,0,9,9"], &points, true),
        one("spdelaunay3d", &[], &points3, true),
        one("spdem", &["--columns", "9"], &mesh, true),
        one("spdem", &["--contours", "50"], &mesh, true),
        one("spview", &[], &mesh, true),
        one("tess3", &[], &text, true),
        one("tess3", &["--table"], &text, true),
        one("dd4", &[], &text4, true),
        one("configgen", &[], &text, true),
        one("splinefit", &["fit", "--step", "20000"], &text, true),
        one("splinefit", &["eval", "--columns", "9"], &spline, true),
        one("splinefit", &["eval", "--at", &text], &spline, true),
        one("splinefit", &["mesh"], &spline, true),
        one("splinefit", &["info"], &spline, false),
        one("spinfo", &[], &mesh, false),
        one("spinfo", &["--audit"], &mesh, false),
        one("spconvert", &["--to", "text"], &mesh, true),
    ]
}

/// Runs a command of the shell, in which `"$0" "$@"` is the tool with its arguments.
fn shell(command: &str, name: &str, arguments: &[&str]) -> Output {
    shell_with(Stdio::null(), command, name, arguments)
}

/// The same with a standard input.
fn shell_with(stdin: impl Into<Stdio>, command: &str, name: &str, arguments: &[&str]) -> Output {
    let mut shell = Command::new("sh");
    shell.args(["-c", command]).arg(tool(name).get_program()).args(arguments);
    shell.stdin(stdin).output().expect("the shell runs")
}

impl Run {
    fn words<'a>(&'a self, more: &[&'a str]) -> Vec<&'a str> {
        self.arguments.iter().map(String::as_str).chain(more.iter().copied()).collect()
    }

    /// The arguments with another input.
    fn words_with<'a>(&'a self, input: &'a str, more: &[&'a str]) -> Vec<&'a str> {
        let replaced = |word| if word == self.input { input } else { word };
        self.words(&[]).into_iter().map(replaced).chain(more.iter().copied()).collect()
    }

    fn assert_shell(&self, command: &str, arguments: &[&str], code: i32, part: &str) {
        let (found, message) = outcome(&shell(command, self.tool, arguments));
        assert_eq!(found, Some(code), "{} {arguments:?} {command}: {message}", self.tool);
        assert!(message.contains(part), "{} {arguments:?} {command}: {message}", self.tool);
        assert!(!message.contains("panicked"), "{message}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn closed_streams_are_errors() {
    let folder = Folder::new();
    for run in runs(&folder) {
        run.assert_shell(r#""$0" "$@" >&-"#, &run.words(&[]), 1, "stdout is closed");
        run.assert_shell(r#""$0" "$@" <&- >&-"#, &run.words(&[]), 1, "stdout is closed");
        run.assert_shell(r#""$0" "$@" >/dev/null"#, &run.words(&[]), 0, "");
        run.assert_shell(r#""$0" "$@" <&-"#, &run.words_with("-", &[]), 1, "stdin is closed");
        for flag in ["--help", "--version"] {
            run.assert_shell(r#""$0" "$@" >&-"#, &[flag], 1, "stdout is closed");
            run.assert_shell(r#""$0" "$@" >/dev/full"#, &[flag], 1, "stdout: printing: ");
        }
        run.assert_shell(r#""$0" "$@" 2>/dev/full"#, &["--no-such-flag"], 2, "");
    }
}

/// Outputs and inputs are compared even if no further file can be opened.
#[test]
#[cfg(target_os = "linux")]
fn few_descriptors_are_the_only_error() {
    let folder = Folder::new();
    for run in runs(&folder) {
        let (words, input) = (run.words_with("-", &[]), fs::File::open(&run.input).unwrap());
        let output = shell_with(input, r#"ulimit -n 4; exec "$0" "$@""#, run.tool, &words);
        let (code, message) = outcome(&output);
        let is_reason = code == Some(1) && message.contains("Too many open files");
        assert!(code == Some(0) || is_reason, "{} {words:?}: {code:?} {message}", run.tool);
    }
}

/// A file must not get descriptor 2, or messages would be written into it.
#[test]
fn closed_stderr_changes_no_output() {
    let folder = Folder::new();
    let output = folder.path("output");
    for run in runs(&folder).iter().filter(|run| run.has_output) {
        let mut written = Vec::new();
        for command in [r#""$0" "$@""#, r#""$0" "$@" <&- 2>&-"#] {
            run.assert_shell(command, &run.words(&["--progress", "json", "-o", &output]), 0, "");
            written.push(fs::read(&output).unwrap());
        }
        assert!(written[0] == written[1], "{} {:?}", run.tool, run.arguments);
    }
}

#[test]
fn outputs_do_not_replace_inputs() {
    let folder = Folder::new();
    for run in runs(&folder) {
        let before = fs::read(&run.input).unwrap();
        let link = folder.path("link");
        drop(fs::remove_file(&link));
        fs::hard_link(&run.input, &link).unwrap();
        let part = "would replace the input";
        if run.has_output {
            run.assert_shell(r#""$0" "$@""#, &run.words(&["-o", &run.input]), 2, part);
            run.assert_shell(r#""$0" "$@""#, &run.words(&["-o", &link]), 2, part);
            let of_stdin = format!(r#""$0" "$@" < '{}'"#, run.input);
            run.assert_shell(&of_stdin, &run.words_with("-", &["-o", &run.input]), 2, part);
        }
        let appended = format!(r#""$0" "$@" >> '{}'"#, run.input);
        run.assert_shell(&appended, &run.words(&[]), 2, part);
        assert!(fs::read(&run.input).unwrap() == before, "{} {:?}", run.tool, run.arguments);
    }
}

#[test]
fn inputs_of_flags_are_not_replaced() {
    let folder = Folder::new();
    let given = folder.write("given", "1\n");
    let list = folder.write("list", "a.txt\n");
    let pictures = folder.write("1.svg", mesh_of_cloud(20));
    let cases: [(&str, &[&str]); 14] = [
        ("spfinalize", &["--lof", &list, "-o", &list]),
        ("spdem", &["--like", &given, "mesh.spm", "-o", &given]),
        ("spview", &[&pictures, "--snapshot", "every=5", "-o", &folder.path("%d.svg")]),
        ("dd4", &["points", "--at-file", &given, "-o", &given]),
        ("configgen", &["knots", "--rule", "data", "--values", &given, "-o", &given]),
        ("configgen", &["knots", "--patches", &given, "-o", &given]),
        ("configgen", &["knots", "--features", &given, "-o", &given]),
        ("splinefit", &["fit", "points", "--knots", &given, "-o", &given]),
        ("splinefit", &["fit", "points", "--features", &given, "--residuals", &given]),
        ("splinefit", &["fit", "points", "--weights", &given, "--robust", "huber", "--rejected", &given]),
        ("splinefit", &["eval", "spline", "--at", &given, "-o", &given]),
        ("splinefit", &["eval", "spline", "--like", &given, "-o", &given]),
        ("tess3", &["--out-dir", &folder.path(""), "--lof", &list, "--summary", &list]),
        ("tess3", &["--out-dir", &folder.path(""), "a.pdb", &given, "--summary", &given]),
    ];
    for (name, arguments) in cases {
        let (code, message) = outcome(&run(name, arguments, &[]));
        assert_eq!(code, Some(2), "{name} {arguments:?}: {message}");
        assert!(message.contains("would replace the input"), "{name} {arguments:?}: {message}");
    }
    assert_eq!(fs::read_to_string(given).unwrap(), "1\n");
}

/// An output of a sweep may have the name of an input of another.
#[test]
fn sweeps_replace_no_input() {
    let folder = Folder::new();
    let points = cloud(20);
    let [first, second] = [folder.write("a", &points), folder.write("out/a.spm", &points)];
    let out = folder.path("out");
    for product in [&[][..], &["--summary", "-"]] {
        let arguments = [&["--out-dir", &out, &first, &second], product].concat();
        let (code, message) = outcome(&run("tess3", &arguments, &[]));
        assert_eq!(code, Some(2), "{message}");
        assert!(message.contains("the output would replace") && message.contains("a.spm"), "{message}");
    }
    assert_eq!(folder.names(""), ["a", "out/a.spm"]);
    assert_eq!(fs::read_to_string(&second).unwrap(), points);
}

#[test]
fn outputs_are_not_mixed() {
    let folder = Folder::new();
    let [a, b] = ["a", "b"].map(|name| folder.path(name));
    let fit = ["fit", "points", "--robust", "tukey"];
    let cases: [&[&str]; 5] = [
        &["-o", &a, "--residuals", &a],
        &["-o", &a, "--rejected", &a],
        &["-o", &a, "--residuals", &b, "--rejected", &b],
        &["--residuals", "-"],
        &["-o", &a, "--residuals", "-", "--rejected", "-"],
    ];
    for case in cases {
        let (code, message) = outcome(&run("splinefit", &[&fit, case].concat(), &[]));
        assert_eq!(code, Some(2), "{case:?}: {message}");
        assert!(message.contains("would be mixed"), "{case:?}: {message}");
    }
    let points = folder.write("points.txt", cloud(200));
    let null = ["fit", &points, "--step", "20000", "-o", "/dev/null", "--residuals", "/dev/null"];
    assert_eq!(outcome(&run("splinefit", &null, &[])).0, Some(0));
}

/// The input does not exist: the run must not get that far.
#[test]
fn bad_outputs_fail_before_the_input_is_read() {
    let folder = Folder::new();
    let file = folder.write("file", "");
    let bad = ["missing/x", "", "new/", "file/x"].map(|name| folder.path(name));
    for run in runs(&folder).iter().filter(|run| run.has_output) {
        for output in &bad {
            let words = run.words_with("no/such/input", &["-o", output]);
            run.assert_shell(r#""$0" "$@""#, &words, 1, &format!("{output}: creating the output: "));
        }
    }
    let list = ["fit", "no/such/input", "--robust", "tukey"];
    for flag in ["--residuals", "--rejected"] {
        let (code, message) =
            outcome(&run("splinefit", &[&list[..], &[flag, &bad[0], "-o", &file]].concat(), &[]));
        assert!(code == Some(1) && message.contains("missing/x: creating"), "{message}");
    }
    let pictures = ["no/such/input", "--snapshot", "every=9", "-o", &folder.path("missing/%d.svg")];
    let (code, message) = outcome(&run("spview", &pictures, &[]));
    assert!(code == Some(1) && message.contains("missing/1.svg: creating"), "{message}");
    let (code, message) = outcome(&run("tess3", &["--out-dir", &file, "no/such/input"], &[]));
    assert!(code == Some(1) && message.contains("file: creating the folder"), "{message}");
}

#[test]
fn replaced_files_keep_permissions_and_links() {
    let folder = Folder::new();
    let text = folder.write("points.txt", cloud(20));
    let old = folder.file("old.spm", "old");
    fs::set_permissions(&old, fs::Permissions::from_mode(0o640)).unwrap();
    symlink("old.spm", folder.root().join("link")).unwrap();
    symlink("new.spm", folder.root().join("dangling")).unwrap();
    for name in ["link", "dangling"] {
        let (code, message) = outcome(&run("spfinalize", &[&text, "-o", &folder.path(name)], &[]));
        assert_eq!(code, Some(0), "{message}");
        assert!(fs::symlink_metadata(folder.path(name)).unwrap().is_symlink());
    }
    assert_eq!(fs::metadata(&old).unwrap().permissions().mode() & 0o7777, 0o640);
    assert_eq!(fs::read(&old).unwrap(), fs::read(folder.path("new.spm")).unwrap());
    assert_eq!(folder.names(""), ["dangling", "link", "new.spm", "old.spm", "points.txt"]);
}
