//! Links between documents: each relative link leads to a file of the tree, and each `#anchor` to a heading.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Documents at the root of the tree.
const AT_ROOT: [&str; 4] = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"];
/// Folders whose documents are checked, at any depth.
const FOLDERS: [&str; 2] = ["docs", "formats"];

#[test]
fn every_relative_link_leads_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut documents: Vec<PathBuf> = AT_ROOT.iter().map(|name| root.join(name)).collect();
    FOLDERS.iter().for_each(|folder| collect(&root.join(folder), &mut documents));
    let mut broken = Vec::new();
    for document in &documents {
        let text = fs::read_to_string(document).unwrap();
        for (line, target) in links(&text) {
            if let Some(fault) = fault(document, &target) {
                let name = document.strip_prefix(root).unwrap().display();
                broken.push(format!("{name}:{line}: {target}: {fault}"));
            }
        }
    }
    assert!(broken.is_empty(), "broken links:\n{}", broken.join("\n"));
}

/// Files and folders of the sources that documents name in full are there; CHANGELOG.md tells of those that
/// were.
#[test]
fn every_named_source_is_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut documents: Vec<PathBuf> = AT_ROOT[..3].iter().map(|name| root.join(name)).collect();
    FOLDERS.iter().for_each(|folder| collect(&root.join(folder), &mut documents));
    let is_part = |c: char| c.is_ascii_alphanumeric() || "/_.-".contains(c);
    let mut gone = Vec::new();
    for document in &documents {
        let text = fs::read_to_string(document).unwrap();
        for part in text
            .split('`')
            .skip(1)
            .step_by(2)
            .filter(|part| part.starts_with("src/") && part.chars().all(is_part))
        {
            // In rules, capitals stand for a name.
            if !root.join(part).exists() && !part.contains("NAME") && !part.contains("SUBJECT") {
                gone.push(format!("{}: {part}", document.strip_prefix(root).unwrap().display()));
            }
        }
    }
    assert!(gone.is_empty(), "documents name sources that are not there:\n{}", gone.join("\n"));
}

/// Adds the Markdown files below a folder.
fn collect(folder: &Path, documents: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, documents);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            documents.push(path);
        }
    }
}

/// What is wrong with a link, if anything.
fn fault(document: &Path, target: &str) -> Option<String> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (path, anchor) = target.split_once('#').map_or((target, None), |(path, anchor)| (path, Some(anchor)));
    let file =
        if path.is_empty() { document.to_path_buf() } else { document.parent().unwrap().join(decoded(path)) };
    if !file.exists() {
        return Some("no such file".to_string());
    }
    let anchor = anchor?;
    let text = fs::read_to_string(&file).ok()?;
    (!anchors(&text).contains(&anchor.to_string())).then(|| "no such heading".to_string())
}

/// A path with its percent escapes of spaces resolved.
fn decoded(path: &str) -> String {
    path.replace("%20", " ")
}

/// The lines of a document outside of fenced and indented code, numbered from one.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_fenced = false;
    let mut was_blank = true;
    let mut is_indented = false;
    text.lines().zip(1..).filter_map(move |(line, number)| {
        let is_fence = line.trim_start().starts_with("```") || line.trim_start().starts_with("~~~");
        is_fenced ^= is_fence;
        // After a blank line, four spaces start a code block; elsewhere they continue a paragraph or a list.
        is_indented = line.starts_with("    ") && (was_blank || is_indented);
        was_blank = line.trim().is_empty();
        (!is_fence && !is_fenced && !is_indented).then_some((number, line))
    })
}

/// The targets of all links and images of a document, with their lines.
fn links(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in prose(text) {
        let line = without_code(line);
        for piece in line.split("](").skip(1) {
            let target = piece.split(')').next().unwrap_or_default();
            found.push((number, target.split_whitespace().next().unwrap_or_default().to_string()));
        }
        // A definition of a reference: `[name]: target`.
        if let Some((name, target)) = line.trim_start().split_once("]: ")
            && name.starts_with('[')
        {
            found.push((number, target.trim().to_string()));
        }
    }
    found
}

/// A line without its spans of code, which may look like links.
fn without_code(line: &str) -> String {
    line.split('`').step_by(2).collect::<Vec<&str>>().join("`")
}

/// The anchors of the headings of a document, as GitHub makes them.
fn anchors(text: &str) -> Vec<String> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let mut found = Vec::new();
    for (_, line) in prose(text) {
        let level = line.bytes().take_while(|&byte| byte == b'#').count();
        let Some(title) = line[level..].strip_prefix(' ').filter(|_| (1..=6).contains(&level)) else {
            continue;
        };
        let anchor = anchor_of(title);
        let count = counts.entry(anchor.clone()).or_default();
        found.push(if *count == 0 { anchor } else { format!("{anchor}-{count}") });
        *count += 1;
    }
    found
}

/// The anchor of a heading: lower case, without punctuation, with hyphens for spaces.
fn anchor_of(title: &str) -> String {
    // Of a link in a heading, the anchor has only the text.
    let mut text = String::new();
    let mut rest = title.trim();
    while let Some((before, after)) = rest.split_once("](") {
        text += before;
        rest = after.split_once(')').map_or("", |(_, after)| after);
    }
    text += rest;
    let kept = text.chars().filter(|&c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.flat_map(char::to_lowercase).map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[test]
fn links_and_anchors_are_read_as_markdown_has_them() {
    let text = "# One `two`: three\n\nA [link](a.md#x) and ![image](b.png), not `[c](d)`.\n\n    [code](e)\n\n\
                ```\n[fenced](f)\n## no heading\n```\n\n## One two three\n[ref]: g.md\n";
    let targets: Vec<String> = links(text).into_iter().map(|(_, target)| target).collect();
    assert_eq!(targets, ["a.md#x", "b.png", "g.md"]);
    assert_eq!(anchors(text), ["one-two-three", "one-two-three-1"]);
    assert_eq!(anchor_of("The [format](x.md), v1.0"), "the-format-v10");
}
