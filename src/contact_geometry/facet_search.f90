!> Search: which facets are near a point: the boxes of the facets in the cells of a uniform grid.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Each facet's box, widened by the search radius, is entered in every cell that it touches. A query then reads one cell
!! and keeps the facets whose widened box holds the point. No facet within the radius is missed; the order is
!! ascending, so that the answer depends on nothing but the numbers. Building costs O(n), a query O(what it finds).
module amontons_facet_search
  use amontons_kinds, only: DP
  use amontons_facets, only: facets_type
  implicit none
  private
  public :: search_type, build_search, near_facets

  integer, parameter :: CELLS_PER_FACET = 8        !< the grid has at most this many cells per facet (and a few more)
  real(DP), parameter :: BULGE = 0.12_DP           !< a box is widened by this part of itself: extension zone, bulges

  !> The grid of one surface in one configuration.
  type :: search_type
    real(DP) :: margin = 0                         !< facets up to this distance are found [length]
    real(DP) :: lower(3) = 0                       !< corner of the grid [length]
    real(DP) :: cell = 1                           !< size of a cell [length]
    integer :: n_cells(3) = 0
    integer, allocatable :: first(:)               !< (cells + 1) start of a cell's facets
    integer, allocatable :: facet(:)               !< facets of all cells, ascending in each
    real(DP), allocatable :: box(:, :, :)          !< (3, 2, n) lower and upper corners of the widened boxes [length]
  end type search_type

contains

  !> Makes the grid for the facets at coordinates x. Cost: O(n) for facets of similar size.
  subroutine build_search(facets, x, margin, search)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: margin                 !< search radius, >= 0 [length]
    type(search_type), intent(out) :: search
    real(DP) :: mean_size
    search%margin = margin
    call make_boxes(facets, x, search, mean_size)
    if (facets%n == 0) return
    call lay_grid(max(mean_size, margin), search)
    call fill_cells(search)
  end subroutine build_search


  !> The facets that may be within the margin of a point, ascending; a superset of those that are.
  pure subroutine near_facets(search, point, list, n)
    type(search_type), intent(in) :: search
    real(DP), intent(in) :: point(3)               !< [length]
    integer, allocatable, intent(inout) :: list(:) !< facets; grows when too short, so it can be used again and again
    integer, intent(out) :: n                      !< number found
    integer :: place(3), c, k, f
    n = 0
    call ensure_size(list, 0)                      ! it has bounds from here on, also where nothing is found
    if (.not. allocated(search%first)) return
    if (any(point < search%lower)) return
    if (any(point > search%lower + search%cell * real(search%n_cells, DP))) return
    place = cell_of(search, point)
    c = cell_number(search, place)
    call ensure_size(list, search%first(c + 1) - search%first(c))
    do k = search%first(c), search%first(c + 1) - 1
      f = search%facet(k)
      if (any(point < search%box(:, 1, f)) .or. any(point > search%box(:, 2, f))) cycle
      n = n + 1
      list(n) = f
    end do
  end subroutine near_facets


  !> The widened boxes, and the mean of their largest sides before the margin is added.
  subroutine make_boxes(facets, x, search, mean_size)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    type(search_type), intent(inout) :: search
    real(DP), intent(out) :: mean_size             !< [length]
    real(DP) :: low(3), high(3), extent
    integer :: f, k
    allocate (search%box(3, 2, facets%n))
    mean_size = 0
    do f = 1, facets%n
      low = x(:, facets%nodes(facets%first(f)))
      high = low
      do k = facets%first(f) + 1, facets%first(f + 1) - 1
        low = min(low, x(:, facets%nodes(k)))
        high = max(high, x(:, facets%nodes(k)))
      end do
      extent = maxval(high - low)
      mean_size = mean_size + extent / real(facets%n, DP)
      search%box(:, 1, f) = low - (search%margin + BULGE * extent)
      search%box(:, 2, f) = high + (search%margin + BULGE * extent)
    end do
  end subroutine make_boxes


  !> Chooses the cells: of the wanted size, or larger if there would be too many.
  subroutine lay_grid(wanted, search)
    real(DP), intent(in) :: wanted                 !< wanted size of a cell [length]
    type(search_type), intent(inout) :: search
    real(DP) :: span(3), most
    integer :: i
    do i = 1, 3
      search%lower(i) = minval(search%box(i, 1, :))
      span(i) = maxval(search%box(i, 2, :)) - search%lower(i)
    end do
    most = real(CELLS_PER_FACET, DP) * real(size(search%box, 3), DP) + 64
    search%cell = max(wanted, maxval(span) / 1.0e6_DP, tiny(1.0_DP))
    do while (product(cells_along(span, search%cell)) > most)
      search%cell = 1.25_DP * search%cell
    end do
    search%n_cells = nint(cells_along(span, search%cell))
  end subroutine lay_grid


  !> Number of cells along each axis, as reals because their product may be huge.
  pure function cells_along(span, cell) result(n)
    real(DP), intent(in) :: span(3), cell          !< [length]
    real(DP) :: n(3)
    n = max(aint(span / cell) + 1, 1.0_DP)
  end function cells_along


  !> Enters the facets in the cells: count, then fill, facet by facet, so that each cell's list ascends.
  subroutine fill_cells(search)
    type(search_type), intent(inout) :: search
    integer, allocatable :: next(:), list(:)
    integer :: f, c, n
    n = product(search%n_cells)
    allocate (next(n), source=0)
    allocate (list(0))
    do f = 1, size(search%box, 3)
      call enter_facet(search, f, next, list)
    end do
    allocate (search%first(n + 1))
    search%first(1) = 1
    do c = 1, n
      search%first(c + 1) = search%first(c) + next(c)
    end do
    next = search%first(:n)
    deallocate (list)
    allocate (list(search%first(n + 1) - 1))
    do f = 1, size(search%box, 3)
      call enter_facet(search, f, next, list)
    end do
    call move_alloc(list, search%facet)
  end subroutine fill_cells


  !> Enters one facet in all cells that its box touches, or only counts it there if the list is empty.
  subroutine enter_facet(search, f, next, list)
    type(search_type), intent(in) :: search
    integer, intent(in) :: f                       !< facet
    integer, intent(inout) :: next(:)              !< (cells) place of the next facet of each cell
    integer, intent(inout) :: list(:)              !< facets of all cells
    integer :: low(3), high(3), i, j, k, c
    low = cell_of(search, search%box(:, 1, f))
    high = cell_of(search, search%box(:, 2, f))
    do k = low(3), high(3)
      do j = low(2), high(2)
        do i = low(1), high(1)
          c = cell_number(search, [i, j, k])
          if (size(list) > 0) list(next(c)) = f
          next(c) = next(c) + 1
        end do
      end do
    end do
  end subroutine enter_facet


  !> The cell of a point, counted from 0 along each axis.
  pure function cell_of(search, point) result(place)
    type(search_type), intent(in) :: search
    real(DP), intent(in) :: point(3)               !< within the grid [length]
    integer :: place(3)
    place = min(max(int((point - search%lower) / search%cell), 0), search%n_cells - 1)
  end function cell_of


  !> The number of a cell, from 1, x fastest.
  pure function cell_number(search, place) result(c)
    type(search_type), intent(in) :: search
    integer, intent(in) :: place(3)                !< counted from 0
    integer :: c
    c = 1 + place(1) + search%n_cells(1) * (place(2) + search%n_cells(2) * place(3))
  end function cell_number


  !> Makes a list at least n long; its content is lost if it grows.
  pure subroutine ensure_size(list, n)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: n
    if (allocated(list)) then
      if (size(list) >= n) return
      deallocate (list)
    end if
    allocate (list(max(n, 32)))
  end subroutine ensure_size

end module amontons_facet_search
