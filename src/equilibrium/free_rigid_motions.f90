!> Rigid body motions that the supports restrain weakly or not at all, and the check whether contact restrains them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/solver.md, "The contact skin". A body is a set of nodes coupled by the
!! stiffness or by rows of the base constraints. Of its six rigid motions z those with small z'Kz over z'diag(K)z are kept for a
!! bulk. A tangent J is singular along the kept motions Z if J Z y = 0 for some y. The preconditioner is positive definite even
!! then, and does not detect it.
module amontons_free_rigid_motions
  use amontons_kinds, only: DP
  use amontons_controls, only: skin_controls_type
  use amontons_containers, only: find_root, unite_trees
  use amontons_sparse, only: sparse_type
  use amontons_constraints, only: constraints_type
  use amontons_dense, only: solve_symmetric_eigen, DENSE_OK
  use amontons_two_level_preconditioner, only: rigid_motion
  implicit none
  private
  public :: free_motions_type, find_motions, is_singular_along

  real(DP), parameter :: TOL_DEPENDENT = 1.0e-10_DP    !< relative eigenvalue below which motions are linearly dependent [-]
  real(DP), parameter :: TOL_GRAM_MATRIX = 1.0e-6_DP       !< |J Z y| over |diag(K) Z y| from the Gram matrix below which it is
                                                           !! recomputed directly [-]

  !> The kept rigid motions.
  type :: free_motions_type
    integer :: n = 0
    real(DP), allocatable :: value(:, :)           !< (n_unknowns, n)
  end type free_motions_type

contains

  !> The rigid motions that the base constraints restrain weakly or not at all.
  subroutine find_motions(controls, stiffness, base, place, is_angle, motions)
    type(skin_controls_type), intent(in) :: controls
    type(sparse_type), intent(in) :: stiffness     !< K, upper triangle with its diagonal
    type(constraints_type), intent(in) :: base     !< eliminated
    real(DP), intent(in) :: place(:, :)            !< (3, n_nodes) coordinates [length]
    logical, intent(in) :: is_angle(:)             !< (n_nodes) its unknowns are angles
    type(free_motions_type), intent(out) :: motions
    integer, allocatable :: body(:)
    real(DP), allocatable :: z(:, :), energy(:, :, :), scale(:, :, :)
    real(DP) :: combination(6, 6)
    integer :: n_bodies, b, k, m, i
    call find_coupled_bodies(stiffness, base, size(place, 2), body, n_bodies)
    allocate (z(6, base%n_unknowns))
    call fill_motions(place, is_angle, body, n_bodies, z)
    call constrain_motions(base, z)
    call measure_motions(stiffness, body, n_bodies, z, energy, scale)
    allocate (motions%value(base%n_unknowns, 0))
    do b = 1, n_bodies
      call weak_combinations(controls%max_motion_energy, energy(:, :, b), scale(:, :, b), m, combination)
      do k = 1, min(m, controls%max_motions - motions%n)
        motions%n = motions%n + 1
        motions%value = reshape(motions%value, [base%n_unknowns, motions%n], pad=[0.0_DP])
        do i = 1, base%n_unknowns
          if (body((i + 2) / 3) == b) motions%value(i, motions%n) = dot_product(combination(:, k), z(:, i))
        end do
      end do
    end do
  end subroutine find_motions


  !> The bodies: nodes coupled by the stiffness or by rows of the base constraints. Method: union-find.
  subroutine find_coupled_bodies(stiffness, base, n_nodes, body, n_bodies)
    type(sparse_type), intent(in) :: stiffness
    type(constraints_type), intent(in) :: base
    integer, intent(in) :: n_nodes
    integer, allocatable, intent(out) :: body(:)   !< (n_nodes) from 1
    integer, intent(out) :: n_bodies
    integer :: parent(n_nodes), i, k, p
    parent = [(i, i=1, n_nodes)]
    do i = 1, stiffness%n_rows, 3                  ! the rows of a node have the same columns
      do p = stiffness%first(i), stiffness%first(i + 1) - 1
        call unite_trees(parent, (i + 2) / 3, (stiffness%column(p) + 2) / 3)
      end do
    end do
    do k = 1, base%n_rows
      do p = 1, size(base%rows(k)%unknown)
        call unite_trees(parent, (base%rows(k)%pivot + 2) / 3, (base%rows(k)%unknown(p) + 2) / 3)
      end do
    end do
    allocate (body(n_nodes), source=0)
    n_bodies = 0
    do i = 1, n_nodes                              ! the root of a tree is its smallest number
      if (parent(i) == i) n_bodies = n_bodies + 1
      if (parent(i) == i) body(i) = n_bodies
      if (parent(i) /= i) body(i) = body(find_root(parent, i))
    end do
  end subroutine find_coupled_bodies


  !> Three translations and three rotations of each body about its centre, scaled by its size.
  pure subroutine fill_motions(place, is_angle, body, n_bodies, z)
    real(DP), intent(in) :: place(:, :)            !< (3, n_nodes) [length]
    logical, intent(in) :: is_angle(:)             !< (n_nodes)
    integer, intent(in) :: body(:), n_bodies
    real(DP), intent(out) :: z(:, :)               !< (6, n_unknowns)
    real(DP) :: low(3, n_bodies), high(3, n_bodies), extent(n_bodies), x(3)
    integer :: i, k, at
    low = huge(1.0_DP)
    high = -huge(1.0_DP)
    do i = 1, size(body)
      if (is_angle(i)) cycle
      low(:, body(i)) = min(low(:, body(i)), place(:, i))
      high(:, body(i)) = max(high(:, body(i)), place(:, i))
    end do
    extent = max(0.5_DP * norm2(max(high - low, 0.0_DP), dim=1), tiny(1.0_DP))
    z = 0.0_DP
    do i = 1, size(body)
      at = 3 * (i - 1)
      if (is_angle(i)) then
        do k = 1, 3
          z(3 + k, at + k) = 1.0_DP / extent(body(i))
        end do
        cycle
      end if
      x = (place(:, i) - 0.5_DP * (low(:, body(i)) + high(:, body(i)))) / extent(body(i))
      do k = 1, 3
        z(:, at + k) = rigid_motion(k, x)
      end do
    end do
  end subroutine fill_motions


  !> Applies the base constraints to the motions: zero at restrained unknowns; dependent unknowns follow from the free ones.
  pure subroutine constrain_motions(base, z)
    type(constraints_type), intent(in) :: base
    real(DP), intent(inout) :: z(:, :)             !< (6, n_unknowns)
    real(DP) :: of_free(6, base%n_free)
    integer :: i, p
    do i = 1, base%n_unknowns
      if (base%free_of(i) > 0) of_free(:, base%free_of(i)) = z(:, i)
    end do
    do i = 1, base%n_unknowns
      if (base%owner(i) == 0) cycle
      z(:, i) = 0.0_DP
      do p = base%transformation%first(i), base%transformation%first(i + 1) - 1
        z(:, i) = z(:, i) + base%transformation%value(p) * of_free(:, base%transformation%column(p))
      end do
    end do
  end subroutine constrain_motions


  !> z'Kz and z'diag(K)z of the motions of each body.
  pure subroutine measure_motions(stiffness, body, n_bodies, z, energy, scale)
    type(sparse_type), intent(in) :: stiffness
    integer, intent(in) :: body(:), n_bodies
    real(DP), intent(in) :: z(:, :)                !< (6, n_unknowns)
    real(DP), allocatable, intent(out) :: energy(:, :, :), scale(:, :, :)   !< (6, 6, n_bodies)
    real(DP) :: product(6)
    integer :: i, p, k, b
    allocate (energy(6, 6, n_bodies), scale(6, 6, n_bodies), source=0.0_DP)
    do i = 1, stiffness%n_rows
      b = body((i + 2) / 3)
      p = stiffness%first(i)
      product = 0.5_DP * stiffness%value(p) * z(:, i)
      do k = 1, 6
        scale(:, k, b) = scale(:, k, b) + stiffness%value(p) * z(:, i) * z(k, i)
      end do
      do p = stiffness%first(i) + 1, stiffness%first(i + 1) - 1
        product = product + stiffness%value(p) * z(:, stiffness%column(p))
      end do
      do k = 1, 6
        energy(:, k, b) = energy(:, k, b) + product * z(k, i) + z(:, i) * product(k)
      end do
    end do
  end subroutine measure_motions


  !> The combinations of a body's motions with small energy over scale.
  subroutine weak_combinations(max_ratio, energy, scale, m, combination)
    real(DP), intent(in) :: max_ratio              !< of energy over scale [-]
    real(DP), intent(in) :: energy(6, 6), scale(6, 6)
    integer, intent(out) :: m
    real(DP), intent(out) :: combination(6, 6)     !< in its first m columns
    real(DP) :: values(6), vectors(6, 6), whiten(6, 6)
    integer :: k, n, status
    m = 0
    call solve_symmetric_eigen(scale, values, vectors, status)
    if (status /= DENSE_OK .or. .not. values(6) > 0.0_DP) return
    n = 0
    whiten = 0.0_DP
    do k = 6, 1, -1
      if (values(k) <= TOL_DEPENDENT * values(6)) exit
      n = n + 1
      whiten(:, n) = vectors(:, k) / sqrt(values(k))
    end do
    vectors = 0.0_DP
    call solve_symmetric_eigen(matmul(transpose(whiten(:, :n)), matmul(energy, whiten(:, :n))), values(:n), vectors(:n, :n), status)
    if (status /= DENSE_OK) return
    m = count(values(:n) <= max_ratio)
    combination(:, :m) = matmul(whiten(:, :n), vectors(:n, :m))
  end subroutine weak_combinations


  !> Whether J is singular along some combination of the columns.
  logical function is_singular_along(images, scales, free_ratio) result(is_singular)
    real(DP), intent(in) :: images(:, :)           !< (n_free, m) J Z [force]
    real(DP), intent(in) :: scales(:, :)           !< (n_free, m) diag(K) Z [force]
    real(DP), intent(in) :: free_ratio             !< |J Z y| over |diag(K) Z y| of a free motion [-]
    real(DP) :: gram(size(images, 2), size(images, 2)), values(size(images, 2)), vectors(size(images, 2), size(images, 2))
    real(DP) :: length(size(images, 2)), y(size(images, 2))
    integer :: k, m, status
    m = size(images, 2)
    is_singular = .false.
    length = norm2(scales, dim=1)
    if (m == 0 .or. any(.not. length > 0.0_DP)) return
    gram = matmul(transpose(images), images)
    do k = 1, m
      gram(:, k) = gram(:, k) / (length * length(k))
    end do
    call solve_symmetric_eigen(gram, values, vectors, status)
    if (status /= DENSE_OK) return
    if (values(1) > TOL_GRAM_MATRIX**2) return
    y = vectors(:, 1) / length
    is_singular = norm2(matmul(images, y)) <= free_ratio * norm2(matmul(scales, y))
  end function is_singular_along

end module amontons_free_rigid_motions
