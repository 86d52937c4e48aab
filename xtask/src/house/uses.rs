//! Imports by `use`, and attributes that leave an item out.

use proc_macro2::{Ident, TokenStream, TokenTree};
use syn::ext::IdentExt;
use syn::{Attribute, Item, ItemUse, Meta, UseTree, Visibility};

/// A path from one name to the next, such as `crate`, `surface`, `Surface`.
pub(super) type Names = Vec<String>;

/// One name, or all names of a module, that a `use` brings in.
#[derive(Clone, Debug)]
pub(super) struct Use {
    pub(super) path: Names,
    /// The name under which it is brought in; none where all are.
    pub(super) name: Option<String>,
    /// Mark of an import that is handed on to others.
    pub(super) public: bool,
}

/// Lists what a `use` brings in, but what begins with `::`, which is another crate's.
pub(super) fn uses(item: &ItemUse) -> Vec<Use> {
    let mut found = Vec::new();
    if item.leading_colon.is_none() {
        let public = !matches!(item.vis, Visibility::Inherited);
        collect(&item.tree, &mut Vec::new(), public, &mut found);
    }
    found
}

fn collect(tree: &UseTree, prefix: &mut Names, public: bool, found: &mut Vec<Use>) {
    let mut add = |last: Option<String>, name: Option<String>| {
        let mut path = prefix.clone();
        path.extend(last.filter(|last| last != "self" || prefix.is_empty()));
        let name = match name.as_deref() {
            Some("self") => path.last().cloned(),
            _ => name,
        };
        found.push(Use { path, name, public });
    };
    match tree {
        UseTree::Path(path) => {
            prefix.push(text(&path.ident));
            collect(&path.tree, prefix, public, found);
            prefix.pop();
        }
        UseTree::Name(name) => add(Some(text(&name.ident)), Some(text(&name.ident))),
        UseTree::Rename(name) => add(Some(text(&name.ident)), Some(text(&name.rename))),
        UseTree::Glob(_) => add(None, None),
        UseTree::Group(group) => {
            for tree in &group.items {
                collect(tree, prefix, public, found);
            }
        }
    }
}

/// The name without the mark of a raw one.
pub(super) fn text(ident: &Ident) -> String {
    ident.unraw().to_string()
}

/// Test for attributes of an item that is only there in tests.
pub(super) fn test_only(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::Path(path) => path.is_ident("test"),
        Meta::List(list) if list.path.is_ident("cfg") => {
            has(&list.tokens, "test") && !has(&list.tokens, "not")
        }
        _ => false,
    })
}

fn has(tokens: &TokenStream, word: &str) -> bool {
    tokens.clone().into_iter().any(|token| match token {
        TokenTree::Ident(ident) => ident == word,
        TokenTree::Group(group) => has(&group.stream(), word),
        _ => false,
    })
}

/// The attributes of an item.
pub(super) fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::ExternCrate(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::ForeignMod(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::TraitAlias(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// The name that an item defines, unless it is a module, an `impl` or a `use`.
pub(super) fn defined(item: &Item) -> Option<String> {
    let ident = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Macro(item) => item.ident.as_ref()?,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::TraitAlias(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(text(ident))
}
