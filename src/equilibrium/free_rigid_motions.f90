!> Rigid body motions that the supports restrain weakly or not at all, and the check whether contact restrains them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/solver.md, "The contact skin". A body is a set of nodes coupled by the
!! stiffness or by rows of the base constraints. Of its six rigid motions z those with small z'Kz over z'diag(K)z are kept for a
!! stiffness. A tangent J is singular along the kept motions Z if J Z y = 0 for some y. The preconditioner is positive definite even
!! then, and does not detect it. A motion moves one body, and its image J z that body and its neighbours: both are sparse.
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
  public :: free_motions_type, sparse_vector_type, find_motions, motion_of, compressed, is_singular_along

  real(DP), parameter :: TOL_DEPENDENT = 1.0e-10_DP    !< relative eigenvalue below which motions are linearly dependent [-]
  real(DP), parameter :: TOL_GRAM_MATRIX = 1.0e-6_DP       !< |J Z y| over |diag(K) Z y| from the Gram matrix below which it is
                                                           !! recomputed directly [-]

  !> The kept rigid motions.
  type :: free_motions_type
    logical :: is_current = .false.                !< they are those of the present stiffness
    integer :: n = 0
    integer, allocatable, private :: body(:)       !< (n) body that a motion moves
    integer, allocatable, private :: number(:)     !< (n) its number among the motions of the body
    integer, allocatable, private :: body_of(:)    !< (n_nodes) body of each node
    real(DP), allocatable, private :: value(:, :)   !< (6, n_unknowns) the motions of the unknown's body
  end type free_motions_type

  !> A vector of which few entries are not 0.
  type :: sparse_vector_type
    integer, allocatable :: at(:)
    real(DP), allocatable :: value(:)
  end type sparse_vector_type

contains

  !> The rigid motions that the base constraints restrain weakly or not at all.
  subroutine find_motions(controls, stiffness, base, place, is_angle, motions)
    type(skin_controls_type), intent(in) :: controls
    type(sparse_type), intent(in) :: stiffness     !< K, upper triangle with its diagonal
    type(constraints_type), intent(in) :: base     !< eliminated
    real(DP), intent(in) :: place(:, :)            !< (3, n_nodes) coordinates [length]
    logical, intent(in) :: is_angle(:)             !< (n_nodes) its unknowns are angles
    type(free_motions_type), intent(out) :: motions
    real(DP), allocatable :: z(:, :), energy(:, :, :), scale(:, :, :)
    real(DP), allocatable :: combination(:, :, :)  ! (6, 6, n_bodies)
    integer :: n_bodies, b, k, m, i
    call find_coupled_bodies(stiffness, base, size(place, 2), motions%body_of, n_bodies)
    allocate (z(6, base%n_unknowns), combination(6, 6, n_bodies))
    call fill_motions(place, is_angle, motions%body_of, n_bodies, z)
    call constrain_motions(base, z)
    call measure_motions(stiffness, motions%body_of, n_bodies, z, energy, scale)
    allocate (motions%body(0), motions%number(0))
    do b = 1, n_bodies
      call weak_combinations(controls%max_motion_energy, energy(:, :, b), scale(:, :, b), m, combination(:, :, b))
      m = min(m, controls%max_motions - motions%n)
      motions%n = motions%n + m
      motions%body = [motions%body, (b, k=1, m)]
      motions%number = [motions%number, (k, k=1, m)]
    end do
    do i = 1, base%n_unknowns
      z(:, i) = matmul(transpose(combination(:, :, motions%body_of((i + 2) / 3))), z(:, i))
    end do
    call move_alloc(z, motions%value)
    motions%is_current = .true.
  end subroutine find_motions


  !> The displacements of a motion.
  pure function motion_of(motions, number) result(z)
    type(free_motions_type), intent(in) :: motions
    integer, intent(in) :: number                  !< from 1 to motions%n
    real(DP) :: z(size(motions%value, 2))
    integer :: i
    do i = 1, size(z)
      z(i) = 0.0_DP
      if (motions%body_of((i + 2) / 3) == motions%body(number)) z(i) = motions%value(motions%number(number), i)
    end do
  end function motion_of


  !> The entries of a vector that are not 0.
  pure type(sparse_vector_type) function compressed(x)
    real(DP), intent(in) :: x(:)
    integer :: i
    compressed%at = pack([(i, i=1, size(x))], abs(x) > 0.0_DP)
    compressed%value = x(compressed%at)
  end function compressed


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
    combination = 0.0_DP
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


  !> Whether J is singular along some combination of motions.
  logical function is_singular_along(n_free, images, scales, free_ratio) result(is_singular)
    integer, intent(in) :: n_free                  !< length of the vectors
    type(sparse_vector_type), intent(in) :: images(:)         !< (m) J Z [force]
    type(sparse_vector_type), intent(in) :: scales(:)         !< (m) diag(K) Z [force]
    real(DP), intent(in) :: free_ratio             !< |J Z y| over |diag(K) Z y| of a free motion [-]
    integer, allocatable :: moved(:)               ! motions that move a free unknown
    real(DP), allocatable :: gram(:, :), values(:), vectors(:, :), length(:), y(:)
    integer :: k, m, status
    is_singular = .false.
    length = [(norm2(scales(k)%value), k=1, size(scales))]
    moved = pack([(k, k=1, size(scales))], length > 0.0_DP)
    length = length(moved)
    m = size(moved)
    if (m == 0) return
    allocate (values(m), vectors(m, m))
    gram = gram_matrix(n_free, images, moved)
    do k = 1, m
      gram(:, k) = gram(:, k) / (length * length(k))
    end do
    call solve_symmetric_eigen(gram, values, vectors, status)
    if (status /= DENSE_OK) return
    if (values(1) > TOL_GRAM_MATRIX**2) return
    y = vectors(:, 1) / length
    is_singular = length_of(n_free, images, moved, y) <= free_ratio * length_of(n_free, scales, moved, y)
  end function is_singular_along


  !> The products of the chosen vectors with each other. (An argument vectors(chosen) would be a copy that gfortran 12 never frees.)
  pure function gram_matrix(n, vectors, chosen) result(gram)
    integer, intent(in) :: n                       !< length of the vectors
    type(sparse_vector_type), intent(in) :: vectors(:)
    integer, intent(in) :: chosen(:)
    real(DP) :: gram(size(chosen), size(chosen))
    real(DP), allocatable :: x(:)
    integer :: k, l
    allocate (x(n), source=0.0_DP)
    do k = 1, size(chosen)
      associate (vector => vectors(chosen(k)))
        x(vector%at) = vector%value
        do l = 1, k
          gram(l, k) = dot_product(x(vectors(chosen(l))%at), vectors(chosen(l))%value)
          gram(k, l) = gram(l, k)
        end do
        x(vector%at) = 0.0_DP
      end associate
    end do
  end function gram_matrix


  !> The length of a sum of the chosen vectors.
  pure real(DP) function length_of(n, vectors, chosen, factors) result(length)
    integer, intent(in) :: n                       !< length of the vectors
    type(sparse_vector_type), intent(in) :: vectors(:)
    integer, intent(in) :: chosen(:)
    real(DP), intent(in) :: factors(:)             !< of the chosen vectors
    real(DP), allocatable :: x(:)
    integer :: k
    allocate (x(n), source=0.0_DP)
    do k = 1, size(chosen)
      associate (vector => vectors(chosen(k)))
        x(vector%at) = x(vector%at) + factors(k) * vector%value
      end associate
    end do
    length = norm2(x)
  end function length_of

end module amontons_free_rigid_motions
