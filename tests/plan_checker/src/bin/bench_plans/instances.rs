//! Which problems there are, and which domain each belongs to.

use std::fs;
use std::path::{Path, PathBuf};

/// A problem and its domain.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Name of the folder.
    pub folder: String,
    /// Name of the problem's file.
    pub file: String,
    pub domain: PathBuf,
    pub problem: PathBuf,
}

impl Instance {
    /// `FOLDER/FILE`.
    pub fn name(&self) -> String {
        format!("{}/{}", self.folder, self.file)
    }
}

/// All instances in the folders of a folder, by name.
pub fn find(folder: &Path) -> Result<Vec<Instance>, String> {
    let mut found = Vec::new();
    for inner in entries(folder)?.into_iter().filter(|path| path.is_dir()) {
        let files = entries(&inner)?;
        for problem in &files {
            let (Some(name), Some(file)) = (file_name(&inner), file_name(problem)) else {
                continue;
            };
            let Some(stem) = file.strip_suffix(".hddl") else {
                continue;
            };
            if stem == "domain" || stem.ends_with("-domain") {
                continue;
            }
            let own = inner.join(format!("{stem}-domain.hddl"));
            let common = inner.join("domain.hddl");
            let domain = [own, common].into_iter().find(|file| file.is_file());
            let missing = || format!("{}: no domain for it", problem.display());
            found.push(Instance {
                folder: name.to_owned(),
                file: file.to_owned(),
                domain: domain.ok_or_else(missing)?,
                problem: problem.clone(),
            });
        }
    }
    Ok(found)
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let failed = |error| format!("cannot read {}: {error}", folder.display());
    let entries = fs::read_dir(folder).map_err(failed)?;
    let mut paths: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    paths.sort();
    Ok(paths)
}

fn file_name(path: &Path) -> Option<&str> {
    path.file_name()?.to_str()
}
