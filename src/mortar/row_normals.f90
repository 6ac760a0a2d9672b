!> Normal of a mortar row: on a convex crease of the slave surface, the direction of its normal cone nearest to the master's normal.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 7, "Normals". A node on a crease has a vertex for each of its sides. With the unit normals
!! a_i of the vertices and the master's mean normal t, turned round, over the node's function,
!!
!!     q = argmin |q - t|  over q = sum l_i a_i, l_i >= 0,        n = q/|q|
!!
!! The cone of a smooth vertex is its normal. Source: the normal cone of a nonsmooth body (C. Kane, E. A. Repetto, M. Ortiz,
!! J. E. Marsden, Comput. Methods Appl. Mech. Engrg. 180 (1999) 1-26).
module amontons_row_normals
  use amontons_kinds, only: DP
  use amontons_tensor, only: IDENTITY, outer_product, invert
  use amontons_element_kinds, only: MAX_FACE_NODES
  use amontons_facets, only: facets_type, facet_nodes
  use amontons_surface_projection, only: evaluate_vertex_normal, evaluate_vertex_derivative
  use amontons_mortar_segmentation, only: segmentation_type
  use amontons_segment_derivatives, only: facet_derivatives_type, differentiate_segmentation
  implicit none
  private
  public :: normal_cone_type, find_row_normal, differentiate_row_normal, project_on_cone

  integer, parameter :: MAX_RAYS = 6               !< sides of a crease that count
  real(DP), parameter :: MIN_DETERMINANT = 1.0e-6_DP   !< of the products of rays: with a smaller one they are dependent [-]

  !> The normal cone of a node, and the direction in it that is nearest to a target.
  type :: normal_cone_type
    integer :: n = 0                               !< rays
    integer :: vertices(MAX_RAYS) = 0              !< of the slave surface
    real(DP) :: rays(3, MAX_RAYS) = 0              !< their unit normals, out of the slave
    real(DP) :: target(3) = 0                      !< t [length^2]
    integer :: n_active = 0                        !< rays that span the face of the cone on which q lies
    integer :: active(3) = 0
    real(DP) :: shares(3) = 0                      !< l of these rays [length^2]
    real(DP) :: q(3) = 0                           !< [length^2]
  end type normal_cone_type

contains

  !> The unit normal of the row of a slave node, out of the slave; zero where its vertex has none.
  pure subroutine find_row_normal(slave, vertices, v, covers, master, x, normal, cone)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: vertices(:)             !< of the node
    integer, intent(in) :: v                       !< the one whose facets form the row
    type(segmentation_type), intent(in) :: covers(:)   !< (slave%n)
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) coordinates [length]
    real(DP), intent(out) :: normal(3)
    type(normal_cone_type), intent(out) :: cone    !< without rays if the normal is that of the vertex
    real(DP) :: m(3)
    integer :: i
    normal = unit(evaluate_vertex_normal(slave, x, v))
    if (size(vertices) == 1 .or. norm2(normal) <= 0.0_DP) return
    cone%n = 1
    cone%vertices(1) = v
    cone%rays(:, 1) = normal
    do i = 1, size(vertices)
      if (vertices(i) == v .or. cone%n == MAX_RAYS) cycle
      m = unit(evaluate_vertex_normal(slave, x, vertices(i)))
      if (.not. (is_behind(slave, x, vertices(i), normal) .and. is_behind(slave, x, v, m))) cycle
      cone%n = cone%n + 1
      cone%vertices(cone%n) = vertices(i)
      cone%rays(:, cone%n) = m
    end do
    if (cone%n > 1) cone%target = facing_normal(slave, v, covers, master, x)
    call project_on_cone(cone)
    if (cone%n_active == 0) then
      cone%n = 0
    else
      normal = unit(cone%q)
    end if
  end subroutine find_row_normal


  !> The direction of a cone nearest to its target, by all sets of up to three rays. Without a target, or with one that points away
  !! from all rays, no ray is active.
  pure subroutine project_on_cone(cone)
    type(normal_cone_type), intent(inout) :: cone
    real(DP) :: inverse(3, 3), shares(3), q(3), least, determinant
    integer :: set, i, n, rays(3)
    cone%n_active = 0
    least = norm2(cone%target)
    if (cone%n < 2 .or. least <= 0.0_DP) return
    do set = 1, 2**cone%n - 1
      n = popcnt(set)
      if (n > 3) cycle
      rays(:n) = pack([(i, i=1, cone%n)], [(btest(set, i - 1), i=1, cone%n)])
      call find_pseudoinverse(cone%rays(:, rays(:n)), inverse, determinant)
      if (determinant < MIN_DETERMINANT) cycle
      shares(:n) = matmul(inverse(:n, :), cone%target)
      if (any(shares(:n) <= 0.0_DP)) cycle
      q = matmul(cone%rays(:, rays(:n)), shares(:n))
      if (norm2(q - cone%target) >= least) cycle
      least = norm2(q - cone%target)
      cone%n_active = n
      cone%active(:n) = rays(:n)
      cone%shares(:n) = shares(:n)
      cone%q = q
    end do
  end subroutine project_on_cone


  !> inv(A'A) A' of up to three columns, and the determinant of A'A.
  pure subroutine find_pseudoinverse(A, inverse, determinant)
    real(DP), intent(in) :: A(:, :)                !< (3, n)
    real(DP), intent(out) :: inverse(3, 3)         !< its first n rows
    real(DP), intent(out) :: determinant
    real(DP) :: products(3, 3), inverse_products(3, 3)
    integer :: n
    n = size(A, 2)
    products = IDENTITY
    products(:n, :n) = matmul(transpose(A), A)
    call invert(products, inverse_products, determinant)
    inverse = 0.0_DP
    inverse(:n, :) = matmul(inverse_products(:n, :n), transpose(A))
  end subroutine find_pseudoinverse


  !> Whether the facets of a vertex lie behind the normal of another one of the same node: the crease between them is convex.
  pure logical function is_behind(slave, x, v, normal)
    type(facets_type), intent(in) :: slave
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer, intent(in) :: v                       !< vertex
    real(DP), intent(in) :: normal(3)              !< of the other one
    real(DP) :: height
    integer :: s, n, nodes(MAX_FACE_NODES)
    height = 0.0_DP
    do s = slave%star_first(v), slave%star_first(v + 1) - 1
      call facet_nodes(slave, slave%star_facet(s), n, nodes)
      height = height + dot_product(normal, sum(x(:, nodes(:n)), dim=2) / real(n, DP) - x(:, nodes(slave%star_local(s))))
    end do
    is_behind = height < 0.0_DP
  end function is_behind


  !> The master's normal over the function of a row, turned round: the sum of -M_ji m_i, with the unit normals m_i of its vertices.
  pure function facing_normal(slave, v, covers, master, x) result(t)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: v                       !< vertex
    type(segmentation_type), intent(in) :: covers(:)
    real(DP), intent(in) :: x(:, :)
    real(DP) :: t(3)                               !< [length^2]
    integer :: s, k, f
    t = 0.0_DP
    do s = slave%star_first(v), slave%star_first(v + 1) - 1
      f = slave%star_facet(s)
      do k = 1, covers(f)%n
        t = t - weighted_normal(master, covers(f)%segments(k)%master, x, covers(f)%segments(k)%master_integrals( &
          slave%star_local(s), :))
      end do
    end do
  end function facing_normal


  !> The weighted sum of the unit normals at the nodes of a facet.
  pure function weighted_normal(facets, f, x, weights) result(m)
    type(facets_type), intent(in) :: facets
    integer, intent(in) :: f                       !< facet
    real(DP), intent(in) :: x(:, :)
    real(DP), intent(in) :: weights(:)             !< of its nodes
    real(DP) :: m(3)
    integer :: i
    m = 0.0_DP
    do i = facets%first(f), facets%first(f + 1) - 1
      m = m + weights(i - facets%first(f) + 1) * unit(evaluate_vertex_normal(facets, x, facets%vertex(i)))
    end do
  end function weighted_normal


  !> The derivative of the normal of a row with respect to the nodes on which it depends. With A the active rays, B = inv(A'A) A'
  !! and l = B t
  !!
  !!     dq = A B dt + (1 - A B) sum l_i da_i + B' [da_i . (t - q)],        dn = (1 - n n')/|q| dq
  !!
  !! Where a master node belongs to several facets over the function that meet in a crease, the change of its weight counts with the
  !! normal of the last of them.
  subroutine differentiate_row_normal(slave, vertices, v, covers, master, x, facet_derivatives, nodes, d_n)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: vertices(:), v          !< as `find_row_normal`
    type(segmentation_type), intent(in) :: covers(:)
    real(DP), intent(in) :: x(:, :)
    type(facet_derivatives_type), intent(inout) :: facet_derivatives(:)  !< (slave%n) those around v are evaluated if needed
    integer, allocatable, intent(out) :: nodes(:)  !< (n) each once
    real(DP), allocatable, intent(out) :: d_n(:, :, :)   !< (3, 3, n) [1/length]
    type(normal_cone_type) :: cone
    real(DP), allocatable :: d_a(:, :, :), d_q(:, :, :)
    real(DP) :: normal(3), inverse(3, 3), within(3, 3), determinant
    integer, allocatable :: own(:)
    integer :: i, j
    call find_row_normal(slave, vertices, v, covers, master, x, normal, cone)
    if (cone%n == 0) then
      call evaluate_vertex_derivative(slave, x, v, nodes, d_n)
      return
    end if
    associate (n => cone%n_active, active => cone%active(:cone%n_active))
      call find_pseudoinverse(cone%rays(:, active), inverse, determinant)
      within = matmul(cone%rays(:, active), inverse(:n, :))
      call differentiate_target(slave, v, covers, master, x, facet_derivatives, nodes, d_q)
      do j = 1, size(nodes)
        d_q(:, :, j) = matmul(within, d_q(:, :, j))
      end do
      do i = 1, n
        call evaluate_vertex_derivative(slave, x, cone%vertices(active(i)), own, d_a)
        do j = 1, size(own)
          call add_derivative(own(j), cone%shares(i) * (d_a(:, :, j) - matmul(within, d_a(:, :, j))) &
            + outer_product(inverse(i, :), matmul(cone%target - cone%q, d_a(:, :, j))), nodes, d_q)
        end do
      end do
    end associate
    d_n = d_q
    do j = 1, size(nodes)
      d_n(:, :, j) = (d_q(:, :, j) - outer_product(normal, matmul(normal, d_q(:, :, j)))) / norm2(cone%q)
    end do
  end subroutine differentiate_row_normal


  !> The derivative of the target: of the weights, and of the normals of the master's vertices.
  subroutine differentiate_target(slave, v, covers, master, x, facet_derivatives, nodes, d_t)
    type(facets_type), intent(in) :: slave, master
    integer, intent(in) :: v
    type(segmentation_type), intent(in) :: covers(:)
    real(DP), intent(in) :: x(:, :)
    type(facet_derivatives_type), intent(inout) :: facet_derivatives(:)
    integer, allocatable, intent(out) :: nodes(:)
    real(DP), allocatable, intent(out) :: d_t(:, :, :)   !< (3, 3, n) [length]
    integer :: s, k, i, f, own
    allocate (nodes(0), d_t(3, 3, 0))
    do s = slave%star_first(v), slave%star_first(v + 1) - 1
      f = slave%star_facet(s)
      own = slave%star_local(s)
      if (covers(f)%n == 0) cycle
      if (.not. facet_derivatives(f)%is_made) call differentiate_segmentation(slave, f, master, x, covers(f), facet_derivatives(f))
      call add_weight_changes(f, own)
      do k = 1, covers(f)%n
        associate (segment => covers(f)%segments(k), first => master%first(covers(f)%segments(k)%master))
          do i = first, master%first(segment%master + 1) - 1
            call add_normal_change(master%vertex(i), segment%master_integrals(own, i - first + 1))
          end do
        end associate
      end do
    end do

  contains

    !> -dM_ji m_i.
    subroutine add_weight_changes(f, own)
      integer, intent(in) :: f, own                !< slave facet, local number of the row's node
      real(DP) :: normals(3, size(facet_derivatives(f)%nodes)), change(3, 3)
      integer :: k, i, j, at
      normals = 0.0_DP
      do k = 1, covers(f)%n
        associate (g => covers(f)%segments(k)%master)
          do i = master%first(g), master%first(g + 1) - 1
            at = facet_derivatives(f)%n_slave + findloc(facet_derivatives(f)%nodes(facet_derivatives(f)%n_slave + 1:), &
              master%nodes(i), dim=1)
            normals(:, at) = unit(evaluate_vertex_normal(master, x, master%vertex(i)))
          end do
        end associate
      end do
      if (.not. allocated(facet_derivatives(f)%d_master_integrals)) return
      do j = 1, size(facet_derivatives(f)%nodes)
        do i = 1, 3
          change(:, i) = -matmul(normals, facet_derivatives(f)%d_master_integrals(own, :, 3 * (j - 1) + i))
        end do
        call add_derivative(facet_derivatives(f)%nodes(j), change, nodes, d_t)
      end do
    end subroutine add_weight_changes

    !> -M_ji dm_i.
    subroutine add_normal_change(vertex, weight)
      integer, intent(in) :: vertex
      real(DP), intent(in) :: weight               !< M_ji [length^2]
      integer, allocatable :: own(:)
      real(DP), allocatable :: d_m(:, :, :)
      integer :: j
      call evaluate_vertex_derivative(master, x, vertex, own, d_m)
      do j = 1, size(own)
        call add_derivative(own(j), -weight * d_m(:, :, j), nodes, d_t)
      end do
    end subroutine add_normal_change

  end subroutine differentiate_target


  !> Adds the derivative with respect to one node, which is appended if it is new.
  pure subroutine add_derivative(node, rate, nodes, rates)
    integer, intent(in) :: node
    real(DP), intent(in) :: rate(3, 3)
    integer, allocatable, intent(inout) :: nodes(:)
    real(DP), allocatable, intent(inout) :: rates(:, :, :)
    integer :: at
    at = findloc(nodes, node, dim=1)
    if (at == 0) then
      nodes = [nodes, node]
      at = size(nodes)
      rates = reshape(rates, [3, 3, at], pad=[0.0_DP])
    end if
    rates(:, :, at) = rates(:, :, at) + rate
  end subroutine add_derivative


  !> A vector over its length; zero for zero.
  pure function unit(m)
    real(DP), intent(in) :: m(3)
    real(DP) :: unit(3)
    unit = m / max(norm2(m), tiny(1.0_DP))
  end function unit

end module amontons_row_normals
