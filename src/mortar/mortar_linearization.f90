!> Row rates: how the row of a slave node of a mortar pair, made of integrals over the facets around it, changes when nodes move.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "Mortar".
module amontons_mortar_linearization
  use amontons_kinds, only: DP
  use amontons_topology, only: MAX_FACE_NODES
  use amontons_facets, only: facets_type, facet_nodes
  use amontons_mortar_segmentation, only: plane_type, lay_plane, in_plane
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_mortar, only: mortar_type, start_row, take_parts, fading
  use amontons_segment_derivatives, only: facet_rates_type, outline_type, differentiate_cuts, turn_of, lay_outline, move_edge, MOST
  implicit none
  private
  public :: row_rates_type, differentiate_row

  !> How a row changes.
  type :: row_rates_type
    integer, allocatable :: nodes(:)               !< (n) those of the row, then all others that it depends on
    real(DP), allocatable :: d_weights(:, :, :)    !< (n_weights, 3, n) dw_k/dx_j [1/length]
    real(DP), allocatable :: d_area(:, :)          !< (3, n) [length]
    real(DP), allocatable :: d_factor(:, :)        !< (3, n) of the logarithm of the factor of the row's shares [1/length]
  end type row_rates_type

  !> How the part changes that a slave node gives to others.
  type :: fade_type
    integer :: node = 0                            !< mesh node
    integer, allocatable :: at(:)                  !< (n) places of nodes of slave and master facet among those of the row
    real(DP), allocatable :: rate(:, :)            !< (3, n) [1/length]
  end type fade_type

contains

  !> How the row of a slave node changes with all nodes of the facets around it: as `mortar` fills it.
  subroutine differentiate_row(mortar, master, x, j, facet_rates, rates)
    type(mortar_type), intent(in) :: mortar        !< as integrated at x
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)                !< as for `integrate_mortar`
    integer, intent(in) :: j                       !< row, with a master in front
    type(facet_rates_type), intent(inout) :: facet_rates(:)   !< (n_facets) those of the star of its vertex are made if they are not
    type(row_rates_type), intent(out) :: rates
    real(DP), allocatable :: sum_of(:, :, :)       ! of d_j T - M_ji, which is w_k times the area
    real(DP), allocatable :: own_area(:, :)
    type(fade_type), allocatable :: fades(:)
    real(DP) :: taken(MAX_FACE_NODES), d_taken(MAX_FACE_NODES, MAX_FACE_NODES), own_share
    integer, allocatable :: at(:)
    integer :: s, f, own, i, k
    associate (slave => mortar%slave, v => mortar%places(j)%vertex)
      do s = slave%star_first(v), slave%star_first(v + 1) - 1
        f = slave%star_facet(s)
        if (.not. facet_rates(f)%is_made) call differentiate_cuts(slave, f, master, x, mortar%cuts%covers(f), facet_rates(f))
      end do
    end associate
    call gather_star(mortar, j, facet_rates, rates%nodes)
    call gather_fades(mortar, master, x, j, rates%nodes, fades)
    k = size(rates%nodes)
    allocate (sum_of(size(mortar%rows(j)%nodes), 3, k), rates%d_area(3, k), own_area(3, k), source=0.0_DP)
    own_share = 0.0_DP
    associate (slave => mortar%slave, row => mortar%rows(j), area => mortar%places(j)%area)
      do s = slave%star_first(mortar%places(j)%vertex), slave%star_first(mortar%places(j)%vertex + 1) - 1
        f = slave%star_facet(s)
        own = slave%star_local(s)
        if (size(facet_rates(f)%nodes) == facet_rates(f)%n_slave) cycle   ! nothing in front
        call take_parts(slave%kind(f), own, mortar%beyond(mortar%place_of(slave%first(f):slave%first(f + 1) - 1)), taken, d_taken)
        at = [(findloc(rates%nodes, facet_rates(f)%nodes(i), dim=1), i=1, size(facet_rates(f)%nodes))]
        own_share = own_share + facet_rates(f)%share(own)
        do i = 1, size(at)
          own_area(:, at(i)) = own_area(:, at(i)) + facet_rates(f)%d_share(own, 3 * i - 2:3 * i)
        end do
        call add_facet(mortar, facet_rates(f), taken, at, row, sum_of, rates%d_area)
        call add_fades(mortar, facet_rates(f), d_taken, fades, at, row, sum_of, rates%d_area)
      end do
      allocate (rates%d_weights, mold=sum_of)
      do i = 1, size(row%nodes)
        rates%d_weights(i, :, :) = (sum_of(i, :, :) - row%weights(i) * rates%d_area) / area
      end do
      rates%d_factor = rates%d_area / area
      if (.not. mortar%is_soft) rates%d_factor = rates%d_factor - own_area / own_share
    end associate
  end subroutine differentiate_row


  !> The nodes of a row, then all others of the facets around it and of their masters.
  pure subroutine gather_star(mortar, j, facet_rates, nodes)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: j
    type(facet_rates_type), intent(in) :: facet_rates(:)
    integer, allocatable, intent(out) :: nodes(:)
    integer :: s, i
    nodes = mortar%rows(j)%nodes
    associate (slave => mortar%slave, v => mortar%places(j)%vertex)
      do s = slave%star_first(v), slave%star_first(v + 1) - 1
        associate (others => facet_rates(slave%star_facet(s))%nodes)
          do i = 1, size(others)
            if (all(nodes /= others(i))) nodes = [nodes, others(i)]
          end do
        end associate
      end do
    end associate
  end subroutine gather_star


  !> How the parts change that nodes around a row give, with the distance of each beyond the edge of its master; nodes on which that
  !! depends are appended.
  subroutine gather_fades(mortar, master, x, j, nodes, fades)
    type(mortar_type), intent(in) :: mortar
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    integer, intent(in) :: j                       !< row
    integer, allocatable, intent(inout) :: nodes(:)
    type(fade_type), allocatable, intent(out) :: fades(:)
    type(fade_type) :: fade
    integer :: s, i, k, n
    allocate (fades(0))
    if (.not. mortar%is_soft) return
    associate (slave => mortar%slave, v => mortar%places(j)%vertex)
      do s = slave%star_first(v), slave%star_first(v + 1) - 1
        do i = slave%first(slave%star_facet(s)), slave%first(slave%star_facet(s) + 1) - 1
          k = mortar%place_of(i)
          if (mortar%beyond(k) <= 0.0_DP .or. mortar%beyond(k) >= 1.0_DP) cycle
          if (any(fades%node == mortar%nodes(k))) cycle
          call differentiate_fade(mortar, master, x, k, fade)
          do n = 1, size(fade%at)                  ! mesh nodes to places
            if (all(nodes /= fade%at(n))) nodes = [nodes, fade%at(n)]
            fade%at(n) = findloc(nodes, fade%at(n), dim=1)
          end do
          fades = [fades, fade]
        end do
      end do
    end associate
  end subroutine gather_fades


  !> How the part that a slave node gives changes with its slave facet and the master's edge beyond which it is.
  subroutine differentiate_fade(mortar, master, x, k, fade)
    type(mortar_type), intent(in) :: mortar
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    integer, intent(in) :: k                       !< slave node
    type(fade_type), intent(out) :: fade           !< at: mesh nodes
    type(outline_type) :: own, front
    type(plane_type) :: plane
    real(DP) :: turn(MOST, 2), across(2), moved(MOST), rate(MOST)
    integer :: i, nd, n, nodes(MAX_FACE_NODES)
    associate (f => mortar%edges(1, k), local => mortar%edges(2, k), g => mortar%edges(3, k), edge => mortar%edges(4, k))
      call lay_plane(mortar%slave, f, x, plane)
      turn = turn_of(mortar%slave, f, x, plane)
      call lay_outline(mortar%slave, f, x, plane, turn, 0, .false., own)
      call lay_outline(master, g, x, plane, turn, own%n, .true., front)
      nd = 3 * (own%n + front%n)
      call move_edge(front, nd, edge, modulo(edge, front%n_corners) + 1, in_plane(plane, own%x(:, local)), across, moved)
      rate = 0.0_DP
      do i = 1, nd
        rate(i) = fading(mortar%beyond(k)) / mortar%slave%edge_length(f) * (dot_product(across, own%d_flat(i, :, local)) - moved(i))
      end do
      call facet_nodes(mortar%slave, f, n, nodes)
      fade%node = mortar%nodes(k)
      fade%at = nodes(:n)
      call facet_nodes(master, g, n, nodes)
      fade%at = [fade%at, nodes(:n)]
      fade%rate = reshape(rate(:nd), [3, nd / 3])
    end associate
  end subroutine differentiate_fade


  !> What one facet gives to the derivative of a row since the parts change that the row takes.
  subroutine add_fades(mortar, facet, d_taken, fades, at, row, sum_of, d_area)
    type(mortar_type), intent(in) :: mortar
    type(facet_rates_type), intent(in) :: facet
    real(DP), intent(in) :: d_taken(MAX_FACE_NODES, MAX_FACE_NODES)
    type(fade_type), intent(in) :: fades(:)
    integer, intent(in) :: at(:)                   !< places of the facet's nodes among those of the row's rates
    type(contact_row_type), intent(in) :: row
    real(DP), intent(inout) :: sum_of(:, :, :), d_area(:, :)
    type(contact_row_type) :: part
    real(DP) :: values(size(row%nodes)), rate(3)
    integer :: i, j, k, q, local, node
    do i = 1, facet%n_slave
      if (all(abs(d_taken(i, :)) <= 0.0_DP)) cycle
      node = findloc(mortar%nodes, facet%nodes(i), dim=1)
      call start_row(mortar%nodes(node), mortar%corners(:, node), part)
      values = 0.0_DP                              ! what the row has of it
      do k = 1, size(part%nodes)
        where (row%nodes == part%nodes(k)) values = values + facet%share(i) * part%weights(k)
      end do
      do k = facet%n_slave + 1, size(facet%nodes)
        if (at(k) <= size(values)) values(at(k)) = values(at(k)) - facet%block(i, k)
      end do
      do q = 1, size(fades)
        local = findloc(facet%nodes(:facet%n_slave), fades(q)%node, dim=1)
        if (local == 0) cycle
        do j = 1, size(fades(q)%at)
          rate = d_taken(i, local) * fades(q)%rate(:, j)
          d_area(:, fades(q)%at(j)) = d_area(:, fades(q)%at(j)) + facet%share(i) * rate
          sum_of(:, :, fades(q)%at(j)) = sum_of(:, :, fades(q)%at(j)) + spread(values, 2, 3) * spread(rate, 1, size(values))
        end do
      end do
    end do
  end subroutine add_fades


  !> What one facet gives to a row: d_i T_i for the functions that the row takes, less the master's part.
  subroutine add_facet(mortar, facet, taken, at, row, sum_of, d_area)
    type(mortar_type), intent(in) :: mortar
    type(facet_rates_type), intent(in) :: facet
    real(DP), intent(in) :: taken(MAX_FACE_NODES)
    integer, intent(in) :: at(:)                   !< places of the facet's nodes among those of the row's rates
    type(contact_row_type), intent(in) :: row
    real(DP), intent(inout) :: sum_of(:, :, :), d_area(:, :)
    type(contact_row_type) :: part
    integer :: i, j, k, q, node
    do i = 1, facet%n_slave
      if (taken(i) <= 0.0_DP) cycle
      node = findloc(mortar%nodes, facet%nodes(i), dim=1)
      call start_row(mortar%nodes(node), mortar%corners(:, node), part)
      do j = 1, size(facet%nodes)
        d_area(:, at(j)) = d_area(:, at(j)) + taken(i) * facet%d_share(i, 3 * j - 2:3 * j)
        do q = 1, size(part%nodes)
          k = findloc(row%nodes, part%nodes(q), dim=1)
          if (k > 0) sum_of(k, :, at(j)) = sum_of(k, :, at(j)) + taken(i) * part%weights(q) * facet%d_share(i, 3 * j - 2:3 * j)
        end do
      end do
      do k = facet%n_slave + 1, size(facet%nodes)
        q = at(k)                                  ! masters of the row stand among its nodes
        if (q > size(row%nodes)) cycle
        do j = 1, size(facet%nodes)
          sum_of(q, :, at(j)) = sum_of(q, :, at(j)) - taken(i) * facet%d_block(i, k, 3 * j - 2:3 * j)
        end do
      end do
    end do
  end subroutine add_facet

end module amontons_mortar_linearization
