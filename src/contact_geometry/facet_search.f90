!> Bucket search: facets whose enlarged bounding boxes contain a point.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Each facet's bounding box, enlarged by the search radius, is entered in every cell of a uniform grid that it touches. A query
!! reads one cell and keeps the facets whose enlarged box contains the point. No facet within the radius is missed; the facets come
!! in ascending order, so that the result is deterministic. Building costs O(n), a query O(number of facets found).
module amontons_facet_search
  use amontons_kinds, only: DP
  use amontons_facets, only: facets_type
  implicit none
  private
  public :: facet_search_type, build_facet_search, renew_facet_search, find_near_facets

  integer, parameter :: MAX_CELLS_PER_FACET = 8        !< the grid has at most this many cells per facet (and a few more)
  real(DP), parameter :: BOX_ENLARGEMENT = 0.12_DP  !< boxes are enlarged by this fraction for extension zone and curvature [-]

  !> The grid of one surface in one configuration.
  type :: facet_search_type
    real(DP) :: margin = 0                         !< facets up to this distance are found [length]
    real(DP) :: lower(3) = 0                       !< corner of the grid [length]
    real(DP) :: cell = 1                           !< size of a cell [length]
    integer :: n_cells(3) = 0
    integer, allocatable :: first(:)               !< (cells + 1) start of a cell's facets
    integer, allocatable :: facet(:)               !< facets of all cells, ascending in each
    real(DP), allocatable :: box(:, :, :)          !< (3, 2, n) lower and upper corners of the widened boxes [length]
    real(DP), allocatable :: place(:, :)           !< (3, size(facets%nodes)) nodes of the facets when it was built [length]
  end type facet_search_type

contains

  !> Builds the grid for the facets at coordinates x. Cost: O(n) for facets of similar size.
  subroutine build_facet_search(facets, x, margin, search)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    real(DP), value :: margin                      !< search radius, >= 0 [length]
    type(facet_search_type), intent(out) :: search
    real(DP) :: mean_size
    search%margin = margin
    call build_boxes(facets, x, search, mean_size)
    if (facets%n == 0) return
    call size_grid(max(mean_size, margin), search)
    call collect_cell_facets(search)
    search%place = x(:, facets%nodes)
  end subroutine build_facet_search


  !> Builds the grid again if a facet has moved farther than `slack` since it was built. A grid with the margin reach + slack thus
  !! misses no facet within the reach, however far the surface moves. Cost otherwise: one comparison for each node.
  subroutine renew_facet_search(facets, x, slack, search)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    real(DP), intent(in) :: slack                  !< part of the margin that motion may use up [length]
    type(facet_search_type), intent(inout) :: search
    if (.not. allocated(search%place)) return
    if (all(abs(x(:, facets%nodes) - search%place) <= slack)) return
    call build_facet_search(facets, x, search%margin, search)
  end subroutine renew_facet_search


  !> The facets that may be within the margin of a point, ascending; a superset of those within it.
  pure subroutine find_near_facets(search, point, list, n)
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: point(3)               !< [length]
    integer, allocatable, intent(inout) :: list(:) !< facets; grows when too short, so it can be reused
    integer, intent(out) :: n                      !< number found
    integer :: cell_index(3), c, k, f
    n = 0
    call ensure_size(list, 0)                      ! allocate it even if nothing is found
    if (.not. allocated(search%first)) return
    if (any(point < search%lower)) return
    if (any(point > search%lower + search%cell * real(search%n_cells, DP))) return
    cell_index = locate_cell(search, point)
    c = cell_number(search, cell_index)
    call ensure_size(list, search%first(c + 1) - search%first(c))
    do k = search%first(c), search%first(c + 1) - 1
      f = search%facet(k)
      if (any(point < search%box(:, 1, f)) .or. any(point > search%box(:, 2, f))) cycle
      n = n + 1
      list(n) = f
    end do
  end subroutine find_near_facets


  !> The enlarged boxes, and the mean of their largest sides before the margin is added.
  subroutine build_boxes(facets, x, search, mean_size)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    type(facet_search_type), intent(inout) :: search
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
      search%box(:, 1, f) = low - (search%margin + BOX_ENLARGEMENT * extent)
      search%box(:, 2, f) = high + (search%margin + BOX_ENLARGEMENT * extent)
    end do
  end subroutine build_boxes


  !> Chooses the cells: of the target size, or larger if there would be too many.
  subroutine size_grid(target_size, search)
    real(DP), intent(in) :: target_size                 !< target size of a cell [length]
    type(facet_search_type), intent(inout) :: search
    real(DP) :: span(3), max_cells
    integer :: i
    do i = 1, 3
      search%lower(i) = minval(search%box(i, 1, :))
      span(i) = maxval(search%box(i, 2, :)) - search%lower(i)
    end do
    max_cells = real(MAX_CELLS_PER_FACET, DP) * real(size(search%box, 3), DP) + 64
    search%cell = max(target_size, maxval(span) / 1.0e6_DP, tiny(1.0_DP))
    do while (product(count_cells(span, search%cell)) > max_cells)
      search%cell = 1.25_DP * search%cell
    end do
    search%n_cells = nint(count_cells(span, search%cell))
  end subroutine size_grid


  !> Number of cells along each axis, as reals because their product may be huge.
  pure function count_cells(span, cell) result(n)
    real(DP), intent(in) :: span(3), cell          !< [length]
    real(DP) :: n(3)
    n = max(aint(span / cell) + 1, 1.0_DP)
  end function count_cells


  !> Enters the facets in the cells: count, then fill, facet by facet, so that each cell's list ascends.
  subroutine collect_cell_facets(search)
    type(facet_search_type), intent(inout) :: search
    integer, allocatable :: next(:), list(:)
    integer :: f, c, n
    n = product(search%n_cells)
    allocate (next(n), source=0)
    allocate (list(0))
    do f = 1, size(search%box, 3)
      call insert_facet(search, f, next, list)
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
      call insert_facet(search, f, next, list)
    end do
    call move_alloc(list, search%facet)
  end subroutine collect_cell_facets


  !> Enters one facet in all cells that its box touches; with an empty list only counts it.
  subroutine insert_facet(search, f, next, list)
    type(facet_search_type), intent(in) :: search
    integer, intent(in) :: f                       !< facet
    integer, intent(inout) :: next(:)              !< (cells) position of the next facet of each cell
    integer, intent(inout) :: list(:)              !< facets of all cells
    integer :: low(3), high(3), i, j, k, c
    low = locate_cell(search, search%box(:, 1, f))
    high = locate_cell(search, search%box(:, 2, f))
    do k = low(3), high(3)
      do j = low(2), high(2)
        do i = low(1), high(1)
          c = cell_number(search, [i, j, k])
          if (size(list) > 0) list(next(c)) = f
          next(c) = next(c) + 1
        end do
      end do
    end do
  end subroutine insert_facet


  !> The cell of a point, counted from 0 along each axis.
  pure function locate_cell(search, point) result(cell_index)
    type(facet_search_type), intent(in) :: search
    real(DP), intent(in) :: point(3)               !< within the grid [length]
    integer :: cell_index(3)
    cell_index = min(max(int((point - search%lower) / search%cell), 0), search%n_cells - 1)
  end function locate_cell


  !> The number of a cell, from 1, x fastest.
  pure function cell_number(search, cell_index) result(c)
    type(facet_search_type), intent(in) :: search
    integer, intent(in) :: cell_index(3)                !< counted from 0
    integer :: c
    c = 1 + cell_index(1) + search%n_cells(1) * (cell_index(2) + search%n_cells(2) * cell_index(3))
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
