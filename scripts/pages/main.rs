//! Writes the man pages and shell completions of all tools: `scripts/manuals FOLDER`.

use std::fs::{self, File};
use std::path::Path;

use clap::{Command, CommandFactory};
use clap_complete::Shell;
use spmesh_convert::flags::spconvert;
use spmesh_molecules::flags::tess3;
use spmesh_pipeline::flags::{spdelaunay2d, spdelaunay3d, spfinalize, spinfo, spnode};
use spmesh_spacetime::flags::dd4;
use spmesh_splines::flags::{configgen, splinefit};
use spmesh_terrain::flags::{
    spcanopy, spconstrain, spdem, spdiff, spground, spheight, spreport, spsimplify, sptiles,
};
use spmesh_view::flags::spview;

fn main() -> std::io::Result<()> {
    let Some(folder) = std::env::args_os().nth(1) else {
        eprintln!("usage: scripts/manuals FOLDER");
        std::process::exit(2);
    };
    let folder = Path::new(&folder);
    let (pages, completions) = (folder.join("man1"), folder.join("completions"));
    fs::create_dir_all(&pages)?;
    fs::create_dir_all(&completions)?;
    for tool in tools() {
        let name = tool.get_name().to_string();
        clap_mangen::Man::new(tool.clone()).render(&mut File::create(pages.join(format!("{name}.1")))?)?;
        for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
            clap_complete::generate_to(shell, &mut tool.clone(), &name, &completions)?;
        }
    }
    println!("man pages are in {}, completions in {}", pages.display(), completions.display());
    Ok(())
}

fn tools() -> [Command; 20] {
    [
        spfinalize::Flags::command(),
        spdelaunay2d::Flags::command(),
        spdelaunay3d::Flags::command(),
        spdem::Flags::command(),
        spconstrain::Flags::command(),
        spground::Flags::command(),
        spheight::Flags::command(),
        spreport::Flags::command(),
        spdiff::Flags::command(),
        spsimplify::Flags::command(),
        sptiles::Flags::command(),
        spnode::Flags::command(),
        spcanopy::Flags::command(),
        spview::Flags::command(),
        tess3::Flags::command(),
        dd4::Flags::command(),
        configgen::Flags::command(),
        splinefit::Flags::command(),
        spinfo::Flags::command(),
        spconvert::Flags::command(),
    ]
}
