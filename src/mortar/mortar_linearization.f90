!> Linearization of mortar constraint rows with respect to the nodal coordinates.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 7.
module amontons_mortar_linearization
  use amontons_kinds, only: DP
  use amontons_element_kinds, only: MAX_FACE_NODES
  use amontons_facets, only: facets_type, facet_nodes
  use amontons_mortar_segmentation, only: projection_plane_type, build_projection_plane, project_on_plane
  use amontons_contact_constraint_rows, only: contact_row_type
  use amontons_mortar, only: mortar_type, fill_slave_part, redistribute_functions, evaluate_transfer_slope
  use amontons_segment_derivatives, only: facet_derivatives_type, facet_outline_type, differentiate_segmentation, &
    differentiate_plane_normal, build_facet_outline, differentiate_edge, MAX_CUT_COORDINATES
  implicit none
  private
  public :: row_derivatives_type, differentiate_mortar_row

  !> Derivatives of a row.
  type :: row_derivatives_type
    integer, allocatable :: nodes(:)               !< (n) those of the row, then all others on which it depends
    real(DP), allocatable :: d_weights(:, :, :)    !< (n_weights, 3, n) dw_k/dx_j [1/length]
    real(DP), allocatable :: d_area(:, :)          !< (3, n) [length]
    real(DP), allocatable :: d_factor(:, :)        !< (3, n) of the logarithm of the row's force factor [1/length]
  end type row_derivatives_type

  !> Derivative of the fraction that a slave node transfers to others.
  type :: transfer_derivative_type
    integer :: node = 0                            !< mesh node
    integer, allocatable :: at(:)                  !< (n) positions of the nodes of slave and master facet among those of the row
    real(DP), allocatable :: rate(:, :)            !< (3, n) [1/length]
  end type transfer_derivative_type

contains

  !> The derivatives of the row of a slave node with respect to all nodes of the facets around it, as `integrate_mortar` builds it.
  subroutine differentiate_mortar_row(mortar, master, x, j, facet_derivatives, derivatives)
    type(mortar_type), intent(in) :: mortar        !< as integrated at x
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)                !< as for `integrate_mortar`
    integer, intent(in) :: j                       !< row of a node with a master in front
    type(facet_derivatives_type), intent(inout) :: facet_derivatives(:)  !< (n_facets) those around the row's vertex are evaluated
                                                                         !! if they are not yet
    type(row_derivatives_type), intent(out) :: derivatives
    real(DP), allocatable :: sum_of(:, :, :)       ! of d_j T - M_ji, which is w_k times the area
    real(DP), allocatable :: own_area(:, :)
    type(transfer_derivative_type), allocatable :: transfers(:)
    real(DP) :: received(MAX_FACE_NODES), d_received(MAX_FACE_NODES, MAX_FACE_NODES), own_fraction
    integer, allocatable :: at(:)
    integer :: s, f, own, i, k
    associate (slave => mortar%slave, v => mortar%places(j)%vertex)
      do s = slave%star_first(v), slave%star_first(v + 1) - 1
        f = slave%star_facet(s)
        if (.not. facet_derivatives(f)%is_made) call differentiate_segmentation(slave, f, master, x, mortar%cuts%covers(f), &
          facet_derivatives(f))
      end do
    end associate
    call collect_row_nodes(mortar, j, facet_derivatives, derivatives%nodes)
    call collect_transfers(mortar, master, x, j, derivatives%nodes, transfers)
    k = size(derivatives%nodes)
    allocate (sum_of(size(mortar%rows(j)%nodes), 3, k), derivatives%d_area(3, k), own_area(3, k), source=0.0_DP)
    own_fraction = 0.0_DP
    associate (slave => mortar%slave, row => mortar%rows(j), area => mortar%places(j)%area)
      do s = slave%star_first(mortar%places(j)%vertex), slave%star_first(mortar%places(j)%vertex + 1) - 1
        f = slave%star_facet(s)
        own = slave%star_local(s)
        if (size(facet_derivatives(f)%nodes) == facet_derivatives(f)%n_slave) cycle   ! no master in front
        call redistribute_functions(slave%kind(f), own, &
          mortar%transferred_fraction(mortar%row_of_entry(slave%first(f):slave%first(f + 1) - 1)), received, d_received)
        at = [(findloc(derivatives%nodes, facet_derivatives(f)%nodes(i), dim=1), i=1, size(facet_derivatives(f)%nodes))]
        own_fraction = own_fraction + facet_derivatives(f)%share(own)
        do i = 1, size(at)
          own_area(:, at(i)) = own_area(:, at(i)) + facet_derivatives(f)%d_slave_integrals(own, 3 * i - 2:3 * i)
        end do
        call add_facet_derivatives(mortar, f, facet_derivatives(f), received, at, row, sum_of, derivatives%d_area)
        call add_transfer_derivatives(mortar, f, facet_derivatives(f), d_received, transfers, at, row, sum_of, derivatives%d_area)
      end do
      allocate (derivatives%d_weights, mold=sum_of)
      do i = 1, size(row%nodes)
        derivatives%d_weights(i, :, :) = (sum_of(i, :, :) - row%weights(i) * derivatives%d_area) / area
      end do
      derivatives%d_factor = derivatives%d_area / area
      if (.not. mortar%is_compliant) derivatives%d_factor = derivatives%d_factor - own_area / own_fraction
    end associate
  end subroutine differentiate_mortar_row


  !> The nodes of a row, then all others of the facets around it and of their masters.
  pure subroutine collect_row_nodes(mortar, j, facet_derivatives, nodes)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: j
    type(facet_derivatives_type), intent(in) :: facet_derivatives(:)
    integer, allocatable, intent(out) :: nodes(:)
    integer :: s, i
    nodes = mortar%rows(j)%nodes
    associate (slave => mortar%slave, v => mortar%places(j)%vertex)
      do s = slave%star_first(v), slave%star_first(v + 1) - 1
        associate (others => facet_derivatives(slave%star_facet(s))%nodes)
          do i = 1, size(others)
            if (all(nodes /= others(i))) nodes = [nodes, others(i)]
          end do
        end associate
      end do
    end associate
  end subroutine collect_row_nodes


  !> The derivatives of the fractions transferred by nodes around a row, which depend on the distance of each beyond the edge of its
  !! master; nodes on which they depend are appended.
  subroutine collect_transfers(mortar, master, x, j, nodes, transfers)
    type(mortar_type), intent(in) :: mortar
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    integer, intent(in) :: j                       !< row
    integer, allocatable, intent(inout) :: nodes(:)
    type(transfer_derivative_type), allocatable, intent(out) :: transfers(:)
    type(transfer_derivative_type) :: transfer
    integer :: s, i, k, n
    allocate (transfers(0))
    if (.not. mortar%is_compliant) return
    associate (slave => mortar%slave, v => mortar%places(j)%vertex)
      do s = slave%star_first(v), slave%star_first(v + 1) - 1
        do i = slave%first(slave%star_facet(s)), slave%first(slave%star_facet(s) + 1) - 1
          k = mortar%row_of_entry(i)
          if (mortar%transferred_fraction(k) <= 0.0_DP .or. mortar%transferred_fraction(k) >= 1.0_DP) cycle
          if (any(transfers%node == mortar%nodes(k))) cycle
          call differentiate_transfer(mortar, master, x, k, transfer)
          do n = 1, size(transfer%at)                  ! mesh nodes to positions in the row
            if (all(nodes /= transfer%at(n))) nodes = [nodes, transfer%at(n)]
            transfer%at(n) = findloc(nodes, transfer%at(n), dim=1)
          end do
          transfers = [transfers, transfer]
        end do
      end do
    end associate
  end subroutine collect_transfers


  !> The derivative of a transferred fraction with respect to the nodes of the slave facet and of the master edge crossed.
  subroutine differentiate_transfer(mortar, master, x, k, transfer)
    type(mortar_type), intent(in) :: mortar
    type(facets_type), intent(in) :: master
    real(DP), intent(in) :: x(:, :)
    integer, intent(in) :: k                       !< slave node
    type(transfer_derivative_type), intent(out) :: transfer           !< at: mesh nodes
    type(facet_outline_type) :: own, front
    type(projection_plane_type) :: plane
    real(DP) :: d_normal(MAX_CUT_COORDINATES, 2), across(2), displacement_rate(MAX_CUT_COORDINATES), rate(MAX_CUT_COORDINATES)
    integer :: i, nd, n, nodes(MAX_FACE_NODES)
    associate (f => mortar%transfer_edges(1, k), local => mortar%transfer_edges(2, k), g => mortar%transfer_edges(3, k), &
      edge => mortar%transfer_edges(4, k))
      call build_projection_plane(mortar%slave, f, x, plane)
      d_normal = differentiate_plane_normal(mortar%slave, f, x, plane)
      call build_facet_outline(mortar%slave, f, x, plane, d_normal, 0, .false., own)
      call build_facet_outline(master, g, x, plane, d_normal, own%n, .true., front)
      nd = 3 * (own%n + front%n)
      call differentiate_edge(front, nd, edge, modulo(edge, front%n_corners) + 1, project_on_plane(plane, own%x(:, local)), &
        across, displacement_rate)
      rate = 0.0_DP
      do i = 1, nd
        rate(i) = evaluate_transfer_slope(mortar%transferred_fraction(k)) / mortar%slave%edge_length(f) * (dot_product(across, &
          own%d_flat(i, :, local)) - displacement_rate(i))
      end do
      call facet_nodes(mortar%slave, f, n, nodes)
      transfer%node = mortar%nodes(k)
      transfer%at = nodes(:n)
      call facet_nodes(master, g, n, nodes)
      transfer%at = [transfer%at, nodes(:n)]
      transfer%rate = reshape(rate(:nd), [3, nd / 3])
    end associate
  end subroutine differentiate_transfer


  !> Contribution of one facet to the derivative of a row through the transferred fractions.
  subroutine add_transfer_derivatives(mortar, f, facet, d_received, transfers, at, row, sum_of, d_area)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: f                       !< slave facet
    type(facet_derivatives_type), intent(in) :: facet
    real(DP), intent(in) :: d_received(MAX_FACE_NODES, MAX_FACE_NODES)
    type(transfer_derivative_type), intent(in) :: transfers(:)
    integer, intent(in) :: at(:)                   !< positions of the facet's nodes among those of the row's derivatives
    type(contact_row_type), intent(in) :: row
    real(DP), intent(inout) :: sum_of(:, :, :), d_area(:, :)
    type(contact_row_type) :: part
    real(DP) :: values(size(row%nodes)), rate(3)
    integer :: i, j, k, q, local, node
    do i = 1, facet%n_slave
      if (all(abs(d_received(i, :)) <= 0.0_DP)) cycle
      node = mortar%row_of_entry(mortar%slave%first(f) + i - 1)
      call fill_slave_part(mortar%nodes(node), mortar%corners(:, node), part)
      values = 0.0_DP                              ! contribution to the row
      do k = 1, size(part%nodes)
        where (row%nodes == part%nodes(k)) values = values + facet%share(i) * part%weights(k)
      end do
      do k = facet%n_slave + 1, size(facet%nodes)
        if (at(k) <= size(values)) values(at(k)) = values(at(k)) - facet%master_integrals(i, k)
      end do
      do q = 1, size(transfers)
        local = findloc(facet%nodes(:facet%n_slave), transfers(q)%node, dim=1)
        if (local == 0) cycle
        do j = 1, size(transfers(q)%at)
          rate = d_received(i, local) * transfers(q)%rate(:, j)
          d_area(:, transfers(q)%at(j)) = d_area(:, transfers(q)%at(j)) + facet%share(i) * rate
          sum_of(:, :, transfers(q)%at(j)) = sum_of(:, :, transfers(q)%at(j)) + spread(values, 2, 3) * spread(rate, 1, size(values))
        end do
      end do
    end do
  end subroutine add_transfer_derivatives


  !> Contribution of one facet to a row: d_i T_i for the functions of the row, less the master's part.
  subroutine add_facet_derivatives(mortar, f, facet, received, at, row, sum_of, d_area)
    type(mortar_type), intent(in) :: mortar
    integer, intent(in) :: f                       !< slave facet
    type(facet_derivatives_type), intent(in) :: facet
    real(DP), intent(in) :: received(MAX_FACE_NODES)
    integer, intent(in) :: at(:)                   !< positions of the facet's nodes among those of the row's derivatives
    type(contact_row_type), intent(in) :: row
    real(DP), intent(inout) :: sum_of(:, :, :), d_area(:, :)
    type(contact_row_type) :: part
    integer :: i, j, k, q, node
    do i = 1, facet%n_slave
      if (received(i) <= 0.0_DP) cycle
      node = mortar%row_of_entry(mortar%slave%first(f) + i - 1)
      call fill_slave_part(mortar%nodes(node), mortar%corners(:, node), part)
      do j = 1, size(facet%nodes)
        d_area(:, at(j)) = d_area(:, at(j)) + received(i) * facet%d_slave_integrals(i, 3 * j - 2:3 * j)
        do q = 1, size(part%nodes)
          k = findloc(row%nodes, part%nodes(q), dim=1)
          if (k > 0) sum_of(k, :, at(j)) = sum_of(k, :, at(j)) + received(i) * part%weights(q) * facet%d_slave_integrals(i, &
            3 * j - 2:3 * j)
        end do
      end do
      do k = facet%n_slave + 1, size(facet%nodes)
        q = at(k)                                  ! the masters of the row are among its nodes
        if (q > size(row%nodes)) cycle
        do j = 1, size(facet%nodes)
          sum_of(q, :, at(j)) = sum_of(q, :, at(j)) - received(i) * facet%d_master_integrals(i, k, 3 * j - 2:3 * j)
        end do
      end do
    end do
  end subroutine add_facet_derivatives

end module amontons_mortar_linearization
