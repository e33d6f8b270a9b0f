// Scroll the menu so that it shows the page that is open.
const menu = document.querySelector(".sidebar-scroll"), here = menu?.querySelector(".current-page > a");
if (here) {
  const [outer, inner] = [menu, here].map(each => each.getBoundingClientRect());
  if (inner.top < outer.top || inner.bottom > outer.bottom) menu.scrollTop += inner.top - outer.top - menu.clientHeight / 2;
}
