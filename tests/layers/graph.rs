//! Which source file imports from which, through modules and re-exports.

use super::source::Source;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The files of one crate.
#[derive(Debug, Default)]
pub(super) struct Graph {
    modules: BTreeMap<Vec<String>, Module>,
}

#[derive(Debug)]
struct Module {
    file: String,
    source: Source,
}

/// One file's import from another.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Import {
    /// File that imports, relative to the crate's sources.
    pub(super) from: String,
    /// File that defines the imported item.
    pub(super) to: String,
    /// Top-level modules that the path names or passes through, each as `layer`.
    pub(super) layers: BTreeSet<String>,
}

impl Graph {
    /// Reads all sources below a folder.
    pub(super) fn read(folder: &Path) -> Self {
        let mut files = Vec::new();
        collect(folder, folder, &mut files);
        Self::new(files.iter().map(|(name, text)| (&**name, &**text)))
    }

    /// Takes file names relative to the crate's sources, and their texts.
    pub(super) fn new<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let mut graph = Self::default();
        for (file, text) in files {
            let module = Module { file: file.to_owned(), source: Source::parse(text) };
            graph.modules.insert(module_of(file), module);
        }
        graph
    }

    /// All imports of one file from another. Files that only declare and re-export are left out:
    /// paths are followed through them.
    pub(super) fn imports(&self) -> BTreeSet<Import> {
        let importing = self.modules.iter().filter(|(_, module)| module.source.has_code);
        importing.flat_map(|(path, module)| self.imports_of(path, module)).collect()
    }

    fn imports_of<'a>(&'a self, path: &'a [String], module: &'a Module) -> impl Iterator<Item = Import> + 'a {
        module.source.paths.iter().filter_map(move |used| {
            let mut passed = BTreeSet::new();
            let found = self.resolve(path, used, &mut passed, 0)?;
            let to = &self.modules[&found];
            let is_import = to.source.has_code && to.file != module.file;
            is_import.then(|| Import { from: module.file.clone(), to: to.file.clone(), layers: passed })
        })
    }

    /// The module that defines what `path` names in the module `at`, or `None` for items of other
    /// crates and for local names.
    fn resolve(
        &self,
        at: &[String],
        path: &[String],
        passed: &mut BTreeSet<String>,
        depth: usize,
    ) -> Option<Vec<String>> {
        let (mut at, mut is_inside) = (at.to_vec(), false);
        for (index, segment) in path.iter().enumerate() {
            match &**segment {
                "crate" => at.clear(),
                "self" => {}
                "super" => drop(at.pop()),
                name => {
                    let child = [&*at, &[name.to_owned()]].concat();
                    if self.modules.contains_key(&child) {
                        at = child;
                    } else if let Some(import) =
                        self.modules[&at].source.imports.get(name).filter(|_| depth < 9)
                    {
                        let rest = [&**import, &path[index + 1..]].concat();
                        return self.resolve(&at, &rest, passed, depth + 1);
                    } else {
                        return is_inside.then_some(at);
                    }
                }
            }
            passed.extend(at.first().cloned());
            is_inside = true;
        }
        Some(at)
    }
}

/// Groups of files that import each other, directly or through others.
pub(super) fn circles(imports: &BTreeSet<Import>) -> Vec<Vec<String>> {
    let mut targets = BTreeMap::<&str, Vec<&str>>::new();
    for import in imports {
        targets.entry(&import.from).or_default().push(&import.to);
    }
    let reached = |from: &str| {
        let (mut found, mut open) = (BTreeSet::new(), vec![from.to_owned()]);
        while let Some(file) = open.pop() {
            for next in targets.get(&*file).into_iter().flatten() {
                if found.insert((*next).to_owned()) {
                    open.push((*next).to_owned());
                }
            }
        }
        found
    };
    let reached: BTreeMap<&str, BTreeSet<String>> =
        targets.keys().map(|file| (*file, reached(file))).collect();
    let mutual = |file: &str| {
        let all = reached[file].iter();
        all.filter(|other| reached.get(&***other).is_some_and(|r| r.contains(file)))
            .cloned()
            .collect::<Vec<_>>()
    };
    let found: BTreeSet<Vec<String>> =
        targets.keys().map(|file| mutual(file)).filter(|c| !c.is_empty()).collect();
    found.into_iter().collect()
}

/// The module path of a file: `a/b.rs` and `a/b/mod.rs` are both `a::b`.
fn module_of(file: &str) -> Vec<String> {
    let mut path: Vec<String> = file.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
    if path.last().is_some_and(|last| last == "mod" || file == "lib.rs") {
        path.pop();
    }
    path
}

fn collect(root: &Path, folder: &Path, files: &mut Vec<(String, String)>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.ends_with("tests") {
            // The files of a test module that is a folder.
        } else if path.is_dir() {
            collect(root, &path, files);
        } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("tests.rs") {
            let name = path.strip_prefix(root).unwrap().components().map(|c| c.as_os_str().to_str().unwrap());
            files.push((name.collect::<Vec<_>>().join("/"), std::fs::read_to_string(&path).unwrap()));
        }
    }
}
