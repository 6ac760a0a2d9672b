!> Bucket search: facets whose enlarged bounding boxes contain a point.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Each facet's bounding box, enlarged by the search radius, is entered in every cell that it touches, of a grid whose cells fit
!! its size: grids of larger facets have cells of twice, four times, ... the size. Cells are hashed into buckets, so that empty
!! space costs nothing, however far bodies are apart. A query reads one bucket for each grid and keeps the facets whose enlarged
!! box contains the point. No facet within the radius is missed; the facets come in ascending order, so that the result is
!! deterministic. Building costs O(n), a query O(number of facets found).
!! References: Teschner et al., Proc. Vision, Modeling, Visualization 2003, 47 (hashed cells); Ericson, Real-Time Collision
!! Detection, Elsevier 2005, sec. 7.2 (grids of several sizes).
module amontons_facet_search
  use amontons_kinds, only: DP, I64
  use amontons_facets, only: facets_type, is_absent_facet
  implicit none
  private
  public :: facet_search_type, build_facet_search, renew_facet_search, find_near_facets

  integer, parameter :: BUCKETS_PER_FACET = 4          !< so that few cells share a bucket
  integer, parameter :: MAX_LEVELS = 30                !< grids
  integer, parameter :: NO_LEVEL = -1                  !< of a facet in no grid
  real(DP), parameter :: MAX_CELLS_PER_SIDE = 2.0_DP   !< largest side of a box over the cells of its grid [-]
  real(DP), parameter :: BOX_ENLARGEMENT = 0.12_DP  !< boxes are enlarged by this fraction for extension zone and curvature [-]

  !> The grids of one surface in one configuration.
  type :: facet_search_type
    real(DP) :: margin = 0                         !< facets up to this distance are found [length]
    real(DP) :: lower(3) = 0, upper(3) = 0         !< corners of the box of all [length]
    real(DP) :: cell(0:MAX_LEVELS) = 1             !< size of a cell of each grid [length]
    logical :: is_used(0:MAX_LEVELS) = .false.     !< a grid has facets
    integer, allocatable :: level(:)               !< (n) grid of each facet, or NO_LEVEL
    integer, allocatable :: first(:)               !< (buckets + 1) start of a bucket's facets
    integer, allocatable :: facet(:)               !< facets of all buckets, ascending in each
    real(DP), allocatable :: box(:, :, :)          !< (3, 2, n) lower and upper corners of the widened boxes; exchanged: no box
                                                   !! [length]
    real(DP), allocatable :: place(:, :)           !< (3, size(facets%nodes)) nodes of the facets when it was built [length]
  end type facet_search_type

contains

  !> Builds the grids for the facets at coordinates x, but for those of removed elements. Cost: O(n).
  subroutine build_facet_search(facets, x, margin, search, own_margins)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) current coordinates [length]
    real(DP), value :: margin                      !< search radius, >= 0 [length]
    type(facet_search_type), intent(out) :: search
    real(DP), intent(in), optional :: own_margins(:)   !< (n) added to the margin of each facet [length]
    search%margin = margin
    call build_boxes(facets, x, search, own_margins)
    if (facets%n == 0) return
    if (allocated(facets%is_absent)) then
      if (all(facets%is_absent)) return
    end if
    call size_grids(search)
    call fill_buckets(search)
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
    integer :: l, c, k, f, n_before
    n = 0
    call ensure_size(list, 0)                      ! allocate it even if nothing is found
    if (.not. allocated(search%first)) return
    if (any(point < search%lower) .or. any(point > search%upper)) return
    do l = 0, MAX_LEVELS
      if (.not. search%is_used(l)) cycle
      c = bucket_of(search, l, cell_index(search, l, point))
      n_before = n
      call extend(list, n, n + search%first(c + 1) - search%first(c))
      do k = search%first(c), search%first(c + 1) - 1
        f = search%facet(k)
        if (search%level(f) /= l .or. any(point < search%box(:, 1, f)) .or. any(point > search%box(:, 2, f))) cycle
        n = n + 1
        list(n) = f
      end do
      call merge_ascending(list(:n), n_before)
    end do
  end subroutine find_near_facets


  !> The enlarged boxes; that of a removed element has its corners exchanged, so that no point is in it.
  subroutine build_boxes(facets, x, search, own_margins)
    type(facets_type), intent(in) :: facets
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    type(facet_search_type), intent(inout) :: search
    real(DP), intent(in), optional :: own_margins(:)   !< (n) [length]
    real(DP) :: low(3), high(3), extent, margin
    integer :: f, k
    allocate (search%box(3, 2, facets%n))
    do f = 1, facets%n
      low = x(:, facets%nodes(facets%first(f)))
      high = low
      do k = facets%first(f) + 1, facets%first(f + 1) - 1
        low = min(low, x(:, facets%nodes(k)))
        high = max(high, x(:, facets%nodes(k)))
      end do
      extent = maxval(high - low)
      margin = search%margin + BOX_ENLARGEMENT * extent
      if (present(own_margins)) margin = margin + own_margins(f)
      search%box(:, 1, f) = low - margin
      search%box(:, 2, f) = high + margin
      if (is_absent_facet(facets, f)) search%box(:, :, f) = search%box(:, 2:1:-1, f)
    end do
  end subroutine build_boxes


  !> Chooses the cells, the smallest ones by the smallest box, and the grid of each facet.
  subroutine size_grids(search)
    type(facet_search_type), intent(inout) :: search
    real(DP) :: side(size(search%box, 3))
    logical :: has_box(size(search%box, 3))
    integer :: f, l
    search%lower = minval(search%box(:, 1, :), dim=2)
    search%upper = maxval(search%box(:, 2, :), dim=2)
    side = maxval(search%box(:, 2, :) - search%box(:, 1, :), dim=1)
    has_box = all(search%box(:, 2, :) >= search%box(:, 1, :), dim=1)
    search%cell(0) = max(minval(side, mask=has_box) / MAX_CELLS_PER_SIDE, maxval(search%upper - search%lower) &
      / 2.0_DP**(MAX_LEVELS - 1), tiny(1.0_DP))
    do l = 1, MAX_LEVELS
      search%cell(l) = 2.0_DP * search%cell(l - 1)
    end do
    allocate (search%level(size(side)), source=NO_LEVEL)
    do f = 1, size(side)
      if (.not. has_box(f)) cycle
      l = 0
      do while (side(f) > MAX_CELLS_PER_SIDE * search%cell(l) .and. l < MAX_LEVELS)
        l = l + 1
      end do
      search%level(f) = l
      search%is_used(l) = .true.
    end do
  end subroutine size_grids


  !> Enters the facets in the buckets: count, then fill, facet by facet, so that each bucket's list ascends.
  subroutine fill_buckets(search)
    type(facet_search_type), intent(inout) :: search
    integer, allocatable :: next(:), last(:), list(:)
    integer :: f, c, n
    n = BUCKETS_PER_FACET * size(search%level) + 1
    allocate (search%first(n + 1))
    allocate (next(n), last(n), source=0)
    allocate (list(0))
    do f = 1, size(search%level)
      call insert_facet(search, f, next, last, list)
    end do
    search%first(1) = 1
    do c = 1, n
      search%first(c + 1) = search%first(c) + next(c)
    end do
    next = search%first(:n)
    last = 0
    deallocate (list)
    allocate (list(search%first(n + 1) - 1))
    do f = 1, size(search%level)
      call insert_facet(search, f, next, last, list)
    end do
    call move_alloc(list, search%facet)
  end subroutine fill_buckets


  !> Enters one facet in the buckets of all cells that its box touches, once in each; with an empty list only counts it.
  subroutine insert_facet(search, f, next, last, list)
    type(facet_search_type), intent(in) :: search
    integer, intent(in) :: f                       !< facet
    integer, intent(inout) :: next(:)              !< (buckets) position of the next facet of each bucket
    integer, intent(inout) :: last(:)              !< (buckets) the last facet entered
    integer, intent(inout) :: list(:)              !< facets of all buckets
    integer :: low(3), high(3), i, j, k, c
    if (search%level(f) == NO_LEVEL) return
    low = cell_index(search, search%level(f), search%box(:, 1, f))
    high = cell_index(search, search%level(f), search%box(:, 2, f))
    do k = low(3), high(3)
      do j = low(2), high(2)
        do i = low(1), high(1)
          c = bucket_of(search, search%level(f), [i, j, k])
          if (last(c) == f) cycle
          last(c) = f
          if (size(list) > 0) list(next(c)) = f
          next(c) = next(c) + 1
        end do
      end do
    end do
  end subroutine insert_facet


  !> The cell of a point in a grid, counted from 0 along each axis.
  pure function cell_index(search, level, point)
    type(facet_search_type), intent(in) :: search
    integer, intent(in) :: level                   !< grid
    real(DP), intent(in) :: point(3)               !< within the box of all [length]
    integer :: cell_index(3)
    cell_index = int((point - search%lower) / search%cell(level))
  end function cell_index


  !> The bucket of a cell, from 1.
  pure integer function bucket_of(search, level, cell)
    type(facet_search_type), intent(in) :: search
    integer, intent(in) :: level                   !< grid
    integer, intent(in) :: cell(3)
    integer(I64), parameter :: FACTORS(3) = [73856093_I64, 19349663_I64, 83492791_I64]   ! primes of Teschner et al.
    bucket_of = 1 + int(modulo(sum(FACTORS * int(cell, I64)) + int(level, I64), size(search%first, kind=I64) - 1))
  end function bucket_of


  !> Merges the first n items of a list with the rest; both ascend.
  pure subroutine merge_ascending(list, n)
    integer, intent(inout) :: list(:)
    integer, intent(in) :: n
    integer :: rest(size(list) - n), i, j
    i = n
    rest = list(n + 1:)
    do j = size(rest), 1, -1
      do while (i > 0)
        if (list(i) < rest(j)) exit
        list(i + j) = list(i)
        i = i - 1
      end do
      list(i + j) = rest(j)
    end do
  end subroutine merge_ascending


  !> Makes a list at least `size_wanted` long; its first n items stay.
  pure subroutine extend(list, n, size_wanted)
    integer, allocatable, intent(inout) :: list(:)
    integer, intent(in) :: n, size_wanted
    integer, allocatable :: longer(:)
    if (size(list) >= size_wanted) return
    allocate (longer(max(size_wanted, 2 * size(list))))
    longer(:n) = list(:n)
    call move_alloc(longer, list)
  end subroutine extend


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
